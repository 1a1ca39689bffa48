# SPDX-License-Identifier: GPL-3.0-or-later
"""Find places inside a level that a picture can be taken from."""
import math

import bpy
import numpy as np
from mathutils import Vector

FAR = 1e4  # m, longest ray
EYE = 1.6  # m, above the floor
CLEARANCE = 0.7  # m, free space around the camera
LOOK_DISTANCE = 12.0  # m, further open space does not make a view better


def sphere_directions(count):
    """Evenly spread unit vectors (Fibonacci)."""
    i = np.arange(count) + 0.5
    z, phi = 1 - 2 * i / count, i * math.pi * (3 - math.sqrt(5))
    r = np.sqrt(1 - z * z)
    return [Vector(v) for v in np.stack([r * np.cos(phi), r * np.sin(phi), z], -1)]


def cast(scene, depsgraph, origin, direction):
    """(distance, True if a front face or nothing was hit)."""
    hit, point, normal, _, _, _ = scene.ray_cast(depsgraph, origin, direction, distance=FAR)
    if not hit:
        return FAR, True
    return (point - origin).length, normal.dot(direction) < 0


def is_inside(scene, depsgraph, point, directions):
    """True if the point sees only front faces, nearly all around, with free space near it."""
    hits = [cast(scene, depsgraph, point, d) for d in directions]
    fronts = sum(front for _, front in hits) / len(hits)
    closed = sum(distance < FAR for distance, _ in hits) / len(hits)
    return fronts > 0.97 and closed > 0.75 and min(distance for distance, _ in hits) > CLEARANCE


def stand_on_floor(scene, depsgraph, point):
    """The point moved to eye height above the floor below it, if there is one."""
    distance, front = cast(scene, depsgraph, point, Vector((0, 0, -1)))
    if not front or distance >= FAR:
        return point
    return point + Vector((0, 0, min(EYE, distance + 0.5) - distance if distance > EYE else 0))


def openness(scene, depsgraph, point, direction):
    """How much there is to see in a cone around a direction."""
    side = direction.cross(Vector((0, 0, 1))).normalized()
    up = side.cross(direction)
    total = 0.0
    for x in (-0.6, -0.3, 0, 0.3, 0.6):
        for y in (-0.3, 0, 0.3):
            distance, _ = cast(scene, depsgraph, point, (direction + x * side + y * up).normalized())
            total += min(distance, LOOK_DISTANCE) if distance < FAR else 0.0  # the sky shows nothing
    return total


def best_direction(scene, depsgraph, point):
    """(openness, direction) of the most open view, a little downwards."""
    options = [
        Vector((math.cos(a), math.sin(a), -0.12)).normalized()
        for a in np.linspace(0, 2 * math.pi, 16, endpoint=False)
    ]
    return max(((openness(scene, depsgraph, point, d), d) for d in options), key=lambda pair: pair[0])


def candidate_points(scene, count, seed):
    """Player starts, lamps, then random points within the scene's bounds."""
    starts = [
        o.matrix_world.translation + Vector((0, 0, 0.8))
        for o in scene.objects
        if str(o.get('classname', '')).startswith('info_player')
    ]
    lights = [
        o.matrix_world.translation.copy() for o in scene.objects if o.type == 'LIGHT' and o.data.type != 'SUN'
    ]
    corners = np.array(
        [o.matrix_world @ Vector(c) for o in scene.objects if o.type == 'MESH' for c in o.bound_box]
    )
    generator = np.random.default_rng(seed)
    low, high = corners.min(0), corners.max(0)
    generator.shuffle(lights)
    return starts + lights + [Vector(low + (high - low) * generator.random(3)) for _ in range(count)]


def find_views(count=3, seed=1, candidates=300):
    """[(position, direction)] of good views far apart from each other."""
    scene, depsgraph = bpy.context.scene, bpy.context.evaluated_depsgraph_get()
    directions, found = sphere_directions(64), []
    for point in candidate_points(scene, candidates, seed):
        point = stand_on_floor(scene, depsgraph, point)
        if is_inside(scene, depsgraph, point, directions):
            found.append((*best_direction(scene, depsgraph, point), point))
        if len(found) >= 40:
            break
    if not found:
        raise RuntimeError("no place inside the level was found")
    return _spread(found, count)


def _spread(found, count):
    """Greedy choice of open views that lie far from the ones chosen before."""
    best = max(found, key=lambda item: item[0])
    chosen = [best]
    while len(chosen) < min(count, len(found)):
        chosen.append(max(found, key=lambda item: item[0] * min((item[2] - c[2]).length for c in chosen)))
    return [(point, direction) for _, direction, point in chosen]
