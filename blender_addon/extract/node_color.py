# SPDX-License-Identifier: GPL-3.0-or-later
"""Colour nodes as fields. Each function takes (evaluator, scope, node, output socket)."""

import numpy as np

from .compat import rec709
from .tree import by_identifier
from .values import LUMINANCE, ONE, ZERO, Field, Inexact, apply, constant, inverted, multiply, replace

_TABLE_SIZE = 256  # Cycles also tabulates ramps and curves


def _rgb(ev, scope, node, socket):
    return constant(rec709(socket.default_value))


def _value(ev, scope, node, socket):
    return constant(socket.default_value)


def _vertex_color(ev, scope, node, socket):
    name = getattr(node, "layer_name", "")
    return Field(color=name, channel="a" if socket.name == "Alpha" else "rgb")


def _attribute(ev, scope, node, socket):
    if node.attribute_type != "GEOMETRY" or not node.attribute_name:
        raise Inexact(f"attribute '{node.attribute_name}' of {node.attribute_type.lower()}")
    if socket.name in {"Fac", "Factor"}:
        raise Inexact(f"factor of attribute '{node.attribute_name}'")
    return Field(color=node.attribute_name, channel="a" if socket.name == "Alpha" else "rgb")


def _invert(ev, scope, node, socket):
    factor, color = ev.scalar(scope, node, "Fac", "Factor"), ev.color(scope, node, "Color")
    if factor.is_constant and factor.constant[0] == 1.0:
        return inverted(color)
    return apply(ev.store, "invert", lambda f, c: c + f * (1.0 - 2.0 * c), factor, color)


def _gamma(ev, scope, node, socket):
    return apply(
        ev.store,
        "gamma",
        lambda c, g: np.where(c > 0.0, np.maximum(c, 0.0) ** g, c),
        ev.color(scope, node, "Color"),
        ev.scalar(scope, node, "Gamma"),
    )


def _bright_contrast(ev, scope, node, socket):
    return apply(
        ev.store,
        "bright contrast",
        lambda c, b, k: np.maximum((1.0 + k) * c + b - k * 0.5, 0.0),
        ev.color(scope, node, "Color"),
        ev.scalar(scope, node, "Bright"),
        ev.scalar(scope, node, "Contrast"),
    )


def _hue_saturation(ev, scope, node, socket):
    inputs = [
        ev.scalar(scope, node, *names) for names in (("Hue",), ("Saturation",), ("Value",), ("Fac", "Factor"))
    ]

    def shift(color, hue, saturation, value, factor):
        h, s, v = np.moveaxis(rgb_to_hsv(color), -1, 0)
        h = (h + hue[:, 0] + 0.5) % 1.0
        s = np.clip(s * saturation[:, 0], 0.0, 1.0)
        result = np.maximum(hsv_to_rgb(np.stack(np.broadcast_arrays(h, s, v * value[:, 0]), -1)), 0.0)
        return factor * result + (1.0 - factor) * color

    return apply(ev.store, "hue saturation", shift, ev.color(scope, node, "Color"), *inputs)


def rgb_to_hsv(rgb):
    """(..., 3) RGB to hue, saturation, value, each in [0, 1] for RGB in [0, 1]."""
    high, low = rgb.max(-1), rgb.min(-1)
    delta = high - low
    safe = np.where(delta > 0.0, delta, 1.0)
    r, g, b = np.moveaxis((high[..., None] - rgb) / safe[..., None], -1, 0)
    hue = np.where(rgb[..., 0] == high, b - g, np.where(rgb[..., 1] == high, 2.0 + r - b, 4.0 + g - r))
    hue = np.where(delta > 0.0, (hue / 6.0) % 1.0, 0.0)
    saturation = np.where(high > 0.0, delta / np.where(high > 0.0, high, 1.0), 0.0)
    return np.stack([hue, saturation, high], -1)


def hsv_to_rgb(hsv):
    """Inverse of rgb_to_hsv."""
    h, s, v = (hsv[..., i, None] for i in range(3))
    ramp = np.clip(np.abs((h * 6.0 + np.array([0.0, 4.0, 2.0])) % 6.0 - 3.0) - 1.0, 0.0, 1.0)
    return v * (1.0 - s + s * ramp)


def _separate(ev, scope, node, socket):
    mode = getattr(node, "mode", "RGB")
    channel = node.outputs.find(socket.name)
    color = ev.color(scope, node, "Color", "Image", "Vector")
    if mode == "HSV":
        return apply(ev.store, ("hsv", channel), lambda c: rgb_to_hsv(c)[:, channel, None], color)
    if mode != "RGB":
        raise Inexact(f"separate {mode}")
    if not color.is_constant and color.channel == "rgb" and len(set(color.value)) == 1:
        return replace(color, channel="rgb"[channel])
    return apply(ev.store, ("separate", channel), lambda c: c[:, channel, None], color)


def _combine(ev, scope, node, socket):
    mode = getattr(node, "mode", "RGB")
    if mode not in {"RGB", "HSV"}:
        raise Inexact(f"combine {mode}")
    parts = [ev.socket(scope, node.inputs[i], True) for i in range(3)]

    def join(*columns):
        rgb = np.concatenate(np.broadcast_arrays(*(c[:, :1] for c in columns)), axis=1)
        return hsv_to_rgb(rgb) if mode == "HSV" else rgb

    return apply(ev.store, ("combine", mode), join, *parts)


def _to_bw(ev, scope, node, socket):
    return apply(ev.store, "luminance", lambda c: (c @ LUMINANCE)[:, None], ev.color(scope, node, "Color"))


def _table(function):
    """Linear interpolation in 256 samples of function(x) -> RGB over [0, 1]."""
    samples = np.array([function(i / (_TABLE_SIZE - 1)) for i in range(_TABLE_SIZE)])

    def look_up(x, channel):
        return np.interp(np.clip(x, 0.0, 1.0), np.linspace(0.0, 1.0, _TABLE_SIZE), samples[:, channel])

    return samples, look_up


def _ramp(ev, scope, node, socket):
    alpha = socket.name == "Alpha"
    factor = ev.scalar(scope, node, "Fac", "Factor")
    ramp = node.color_ramp
    samples, look_up = _table(lambda x: (ramp.evaluate(x)[3],) * 3 if alpha else rec709(ramp.evaluate(x)))
    name = ("ramp", samples.tobytes())
    return apply(ev.store, name, lambda x: np.stack([look_up(x[:, 0], c) for c in range(3)], 1), factor)


def _curves(ev, scope, node, socket):
    mapping = node.mapping
    mapping.initialize()
    curves = mapping.curves
    samples, look_up = _table(
        lambda x: [mapping.evaluate(curves[c], mapping.evaluate(curves[3], x)) for c in range(3)]
    )

    def bend(factor, color):
        bent = np.stack([look_up(color[:, c], c) for c in range(3)], 1)
        return factor * bent + (1.0 - factor) * color

    return apply(
        ev.store,
        ("curves", samples.tobytes()),
        bend,
        ev.scalar(scope, node, "Fac", "Factor"),
        ev.color(scope, node, "Color"),
    )


def _blackbody(ev, scope, node, socket):
    return constant(blackbody(ev.number(scope, node, "Temperature")))


def blackbody(kelvin):
    """Rec.709 colour of a black body, luminance 1: Planck's law through the CIE 1931 observer
    (analytic fit of Wyman, Sloan and Shirley, JCGT 2013)."""
    nm = np.arange(380.0, 781.0, 5.0)
    t = max(float(kelvin), 800.0)
    power = nm**-5.0 / np.expm1(np.minimum(1.438777e7 / (nm * t), 700.0))

    def lobe(mean, left, right):
        return np.exp(-0.5 * ((nm - mean) * np.where(nm < mean, left, right)) ** 2)

    x = (
        0.362 * lobe(442.0, 0.0624, 0.0374)
        + 1.056 * lobe(599.8, 0.0264, 0.0323)
        - 0.065 * lobe(501.1, 0.0490, 0.0382)
    )
    y = 0.821 * lobe(568.8, 0.0213, 0.0247) + 0.286 * lobe(530.9, 0.0613, 0.0322)
    z = 1.217 * lobe(437.0, 0.0845, 0.0278) + 0.681 * lobe(459.0, 0.0385, 0.0725)
    xyz = np.array([(power * bar).sum() for bar in (x, y, z)])
    rgb = np.array(
        [
            [3.2404542, -1.5371385, -0.4985314],
            [-0.9692660, 1.8760108, 0.0415560],
            [0.0556434, -0.2040259, 1.0572252],
        ]
    ) @ (xyz / xyz[1])
    return tuple(np.maximum(rgb, 0.0))


_BLENDS = {
    "MIX": lambda a, b: b,
    "ADD": lambda a, b: a + b,
    "MULTIPLY": lambda a, b: a * b,
    "SUBTRACT": lambda a, b: a - b,
    "SCREEN": lambda a, b: 1.0 - (1.0 - a) * (1.0 - b),
    "DIFFERENCE": lambda a, b: np.abs(a - b),
    "DARKEN": np.minimum,
    "LIGHTEN": np.maximum,
    "DIVIDE": lambda a, b: np.where(b != 0.0, a / np.where(b != 0.0, b, 1.0), a),
    "EXCLUSION": lambda a, b: np.maximum(a + b - 2.0 * a * b, 0.0),
    "OVERLAY": lambda a, b: np.where(a < 0.5, 2.0 * a * b, 1.0 - 2.0 * (1.0 - a) * (1.0 - b)),
    "LINEAR_LIGHT": lambda a, b: a + 2.0 * b - 1.0,
}


def _mix_rgb(ev, scope, node, socket):
    factor = ev.scalar(scope, node, "Fac", "Factor")
    a, b = ev.socket(scope, node.inputs[1]), ev.socket(scope, node.inputs[2])
    return _blend(ev, node.blend_type, factor, a, b, True, node.use_clamp)


def _mix(ev, scope, node, socket):
    kind = {"FLOAT": "Float", "VECTOR": "Vector", "RGBA": "Color"}.get(node.data_type)
    if kind is None:
        raise Inexact(f"mix of {node.data_type.lower()}")
    vector = kind == "Vector" and node.factor_mode == "NON_UNIFORM"
    sockets = [
        by_identifier(node.inputs, name)
        for name in ("Factor_Vector" if vector else "Factor_Float", f"A_{kind}", f"B_{kind}")
    ]
    factor, a, b = (ev.socket(scope, s) for s in sockets)
    blend = node.blend_type if kind == "Color" else "MIX"
    return _blend(ev, blend, factor, a, b, node.clamp_factor, kind == "Color" and node.clamp_result)


def _blend(ev, blend, factor, a, b, clamp_factor, clamp_result):
    if blend not in _BLENDS:
        raise Inexact(f"blend mode {blend.lower()}")
    f = factor.constant[0] if factor.is_constant else None
    if f is not None and clamp_factor:
        f = min(max(f, 0.0), 1.0)
    if not clamp_result:
        if f == 0.0:
            return a
        if f == 1.0 and blend == "MIX":
            return b
        if blend == "MULTIPLY" and f == 1.0:
            return multiply(ev.store, a, b)
        if blend == "MULTIPLY" and f is not None and b.is_constant:
            return ev.tinted(a, tuple(1.0 - f + f * v for v in b.constant))
        if blend == "MIX" and factor.is_constant and b == ZERO:
            return ev.tinted(a, (1.0 - f,) * 3)
        if blend == "MIX" and a == ZERO and f != 0.0:
            return multiply(ev.store, b, factor)
        if blend == "MIX" and a == ONE and b == ZERO:
            return inverted(factor)

    def function(t, x, y):
        t = np.clip(t, 0.0, 1.0) if clamp_factor else t
        result = x + t * (_BLENDS[blend](x, y) - x)
        return np.clip(result, 0.0, 1.0) if clamp_result else result

    return apply(ev.store, ("mix", blend, clamp_factor, clamp_result), function, factor, a, b)


_CAMERA = {
    "Is Camera Ray": 0.0,
    "Is Shadow Ray": 0.0,
    "Is Diffuse Ray": 1.0,
    "Is Glossy Ray": 0.0,
    "Is Singular Ray": 0.0,
    "Is Reflection Ray": 1.0,
    "Is Transmission Ray": 0.0,
}


def _light_path(ev, scope, node, socket):
    if socket.name not in _CAMERA:
        raise Inexact(f"Light Path {socket.name}")
    if socket.name == "Is Shadow Ray":
        ev.warn("Light Path 'Is Shadow Ray' is taken as 0: gather and shadow rays see one material")
    return constant(_CAMERA[socket.name])


def _fresnel(ev, scope, node, socket):
    ior = max(ev.number(scope, node, "IOR", default=1.45), 1.0001)
    f0 = ((ior - 1.0) / (ior + 1.0)) ** 2
    ev.warn("Fresnel depends on the view; its mean over the hemisphere is used")
    return constant(f0 + (1.0 - f0) / 21.0)


def _layer_weight(ev, scope, node, socket):
    blend = min(max(ev.number(scope, node, "Blend", default=0.5), 0.0), 0.99999)
    ev.warn("Layer Weight depends on the view; its mean over the hemisphere is used")
    if socket.name == "Fresnel":
        ior = 1.0 / max(1.0 - blend, 1e-5)
        f0 = ((ior - 1.0) / (ior + 1.0)) ** 2
        return constant(f0 + (1.0 - f0) / 21.0)
    exponent = 2.0 * blend if blend < 0.5 else 0.5 / (1.0 - blend)
    return constant(1.0 - 2.0 / (exponent + 2.0))  # 2 * integral of (1 - mu^exponent) mu


def _occlusion(ev, scope, node, socket):
    ev.warn("Ambient Occlusion nodes are taken as unoccluded: the bake makes real occlusion")
    return ev.color(scope, node, "Color") if socket.name == "Color" else ONE


NODES = {
    "ShaderNodeRGB": _rgb,
    "ShaderNodeValue": _value,
    "ShaderNodeVertexColor": _vertex_color,
    "ShaderNodeAttribute": _attribute,
    "ShaderNodeInvert": _invert,
    "ShaderNodeGamma": _gamma,
    "ShaderNodeBrightContrast": _bright_contrast,
    "ShaderNodeHueSaturation": _hue_saturation,
    "ShaderNodeSeparateRGB": _separate,
    "ShaderNodeSeparateColor": _separate,
    "ShaderNodeSeparateXYZ": _separate,
    "ShaderNodeCombineXYZ": _combine,
    "ShaderNodeCombineRGB": _combine,
    "ShaderNodeCombineColor": _combine,
    "ShaderNodeRGBToBW": _to_bw,
    "ShaderNodeValToRGB": _ramp,
    "ShaderNodeRGBCurve": _curves,
    "ShaderNodeBlackbody": _blackbody,
    "ShaderNodeMixRGB": _mix_rgb,
    "ShaderNodeMix": _mix,
    "ShaderNodeLightPath": _light_path,
    "ShaderNodeFresnel": _fresnel,
    "ShaderNodeLayerWeight": _layer_weight,
    "ShaderNodeAmbientOcclusion": _occlusion,
}
