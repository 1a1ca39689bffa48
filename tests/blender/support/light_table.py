# SPDX-License-Identifier: GPL-3.0-or-later
"""The light cases as plain data: name -> (builder in light_cases, arguments). No bpy here."""
from math import pi


def _point(radius, **more):
    return 'lamp', {'kind': 'POINT', 'energy': 100, 'shadow_soft_size': radius, **more}


def _spot(angle, blend, radius=0.0, scale=(1, 1, 1)):
    return 'lamp', {
        'kind': 'SPOT',
        'energy': 100,
        'shadow_soft_size': radius,
        'spot_size': angle,
        'spot_blend': blend,
        'scale': scale,
    }


def _sun(angle):
    return 'sun', {'energy': 3, 'angle': angle}


def _area(shape, x, y=None, spread=pi, scale=(1, 1, 1)):
    return 'lamp', {
        'kind': 'AREA',
        'energy': 100,
        'shape': shape,
        'size': x,
        'size_y': y or x,
        'spread': spread,
        'scale': scale,
    }


# Square and rectangle lamps far smaller than their distance are left out: the reference itself
# loses precision there (5% at 1 cm and 1.5 m).
CASES = {
    'point_r0': _point(0.0),
    'point_r0.1': _point(0.1),
    'point_r0.5': _point(0.5),
    'point_colour': _point(0.05, color=(1.0, 0.4, 0.1)),
    'spot_60_hard': _spot(1.05, 0.0),
    'spot_60_soft': _spot(1.05, 1.0),
    'spot_120': _spot(2.1, 0.15),
    'spot_180': _spot(pi, 0.5),
    'spot_r0.3': _spot(2.1, 0.4, 0.3),
    'spot_scaled': _spot(1.5, 0.4, 0.1, (2, -3, 0.5)),
    'sun_0': _sun(0.0),
    'sun_0.25': _sun(0.25),
    'sun_1': _sun(1.0),
    'sun_2': _sun(2.0),
    'square': _area('SQUARE', 0.8),
    'square_small': _area('SQUARE', 0.1),
    'square_big': _area('SQUARE', 3.0),
    'rectangle': _area('RECTANGLE', 0.8, 0.3),
    'rectangle_scaled': _area('RECTANGLE', 0.8, 0.3, scale=(-1, 2, 3)),
    'disk': _area('DISK', 0.8),
    'disk_tiny': _area('DISK', 0.01),
    'ellipse': _area('ELLIPSE', 0.8, 0.3),
    'square_spread_2.5': _area('SQUARE', 0.8, spread=2.5),
    'square_spread_1.2': _area('SQUARE', 0.4, spread=1.2),
    'ellipse_spread_1.5': _area('ELLIPSE', 0.8, 0.3, spread=1.5),
    'emission': ('emitter', {}),
    'emission_flipped': ('emitter', {'flip': True}),
    'emission_principled': ('emitter', {'principled': True}),
    'world': ('sky', {}),
    'world_texture': ('sky', {'textured': True}),
}
