# SPDX-License-Identifier: GPL-3.0-or-later
"""Math nodes as fields, and vector nodes as affine maps of texture coordinates."""

import numpy as np

from .values import Inexact, apply, multiply

_MATH = {
    "ADD": (2, lambda a, b: a + b),
    "SUBTRACT": (2, lambda a, b: a - b),
    "MULTIPLY": (2, lambda a, b: a * b),
    "DIVIDE": (2, lambda a, b: _divide(a, b)),
    "MULTIPLY_ADD": (3, lambda a, b, c: a * b + c),
    "POWER": (2, lambda a, b: _power(a, b)),
    "MINIMUM": (2, np.minimum),
    "MAXIMUM": (2, np.maximum),
    "LESS_THAN": (2, lambda a, b: (a < b) * 1.0),
    "GREATER_THAN": (2, lambda a, b: (a > b) * 1.0),
    "SQRT": (1, lambda a: np.sqrt(np.maximum(a, 0.0))),
    "ABSOLUTE": (1, np.abs),
    "EXPONENT": (1, np.exp),
    "SIGN": (1, np.sign),
    "ROUND": (1, lambda a: np.floor(a + 0.5)),
    "FLOOR": (1, np.floor),
    "CEIL": (1, np.ceil),
    "TRUNC": (1, np.trunc),
    "FRACT": (1, lambda a: a - np.floor(a)),
    "MODULO": (2, lambda a, b: _modulo(a, b)),
    "SINE": (1, np.sin),
    "COSINE": (1, np.cos),
    "TANGENT": (1, np.tan),
    "RADIANS": (1, np.radians),
    "DEGREES": (1, np.degrees),
    "INVERSE_SQRT": (1, lambda a: _divide(np.ones_like(a), np.sqrt(np.maximum(a, 0.0)))),
}

_VECTOR = {
    "ADD": (2, lambda a, b: a + b),
    "SUBTRACT": (2, lambda a, b: a - b),
    "MULTIPLY": (2, lambda a, b: a * b),
    "DIVIDE": (2, lambda a, b: _divide(a, b)),
    "MULTIPLY_ADD": (3, lambda a, b, c: a * b + c),
    "SCALE": (4, lambda a, s: a * s),
    "MINIMUM": (2, np.minimum),
    "MAXIMUM": (2, np.maximum),
    "ABSOLUTE": (1, np.abs),
    "FLOOR": (1, np.floor),
    "CEIL": (1, np.ceil),
    "FRACTION": (1, lambda a: a - np.floor(a)),
    "DOT_PRODUCT": (2, lambda a, b: (a * b).sum(1, keepdims=True)),
    "LENGTH": (1, lambda a: np.sqrt((a * a).sum(1, keepdims=True))),
}


def _divide(a, b):
    return np.where(b != 0.0, a / np.where(b != 0.0, b, 1.0), 0.0)


def _power(a, b):
    with np.errstate(all="ignore"):
        result = np.power(a, b)
    return np.where(np.isfinite(result), result, 0.0)


def _modulo(a, b):
    return np.where(b != 0.0, np.fmod(a, np.where(b != 0.0, b, 1.0)), 0.0)


def _math(ev, scope, node, socket):
    if node.operation not in _MATH:
        raise Inexact(f"math operation {node.operation.lower()}")
    count, function = _MATH[node.operation]
    fields = [ev.socket(scope, node.inputs[i], True) for i in range(count)]
    if node.operation == "MULTIPLY" and not node.use_clamp:
        return multiply(ev.store, *fields)
    clamp = node.use_clamp

    def run(*arrays):
        result = function(*(a[:, :1] for a in arrays))
        return np.clip(result, 0.0, 1.0) if clamp else result

    return apply(ev.store, ("math", node.operation, clamp), run, *fields)


def _vector_math(ev, scope, node, socket):
    if node.operation not in _VECTOR:
        raise Inexact(f"vector operation {node.operation.lower()}")
    count, function = _VECTOR[node.operation]
    indices = (0, 3) if count == 4 else range(count)
    fields = [ev.socket(scope, node.inputs[i]) for i in indices]
    return apply(ev.store, ("vector math", node.operation), function, *fields)


def _clamp(ev, scope, node, socket):
    value, low, high = (ev.socket(scope, node.inputs[i]) for i in range(3))
    ranged = node.clamp_type == "RANGE"

    def run(x, a, b):
        return np.clip(x, np.minimum(a, b), np.maximum(a, b)) if ranged else np.minimum(np.maximum(x, a), b)

    return apply(ev.store, ("clamp", ranged), run, value, low, high)


def _map_range(ev, scope, node, socket):
    if getattr(node, "data_type", "FLOAT") != "FLOAT" or node.interpolation_type != "LINEAR":
        raise Inexact(f"map range {node.interpolation_type.lower()}")
    fields = [ev.socket(scope, node.inputs[i]) for i in range(5)]
    clamp = node.clamp

    def run(x, a, b, c, d):
        t = _divide(x - a, b - a)
        return c + (np.clip(t, 0.0, 1.0) if clamp else t) * (d - c)

    return apply(ev.store, ("map range", clamp), run, *fields)


NODES = {
    "ShaderNodeMath": _math,
    "ShaderNodeVectorMath": _vector_math,
    "ShaderNodeClamp": _clamp,
    "ShaderNodeMapRange": _map_range,
}


def affine(ev, scope, node):
    """2x3 map of (u, v) by a Mapping or Vector Math node with constant inputs; raises Inexact."""
    if node.bl_idname == "ShaderNodeMapping":
        return _mapping(ev, scope, node)
    if node.operation not in {"ADD", "SUBTRACT", "MULTIPLY", "SCALE", "DIVIDE"}:
        raise Inexact(f"vector operation {node.operation.lower()} on coordinates")
    field = ev.socket(scope, node.inputs[3 if node.operation == "SCALE" else 1])
    if not field.is_constant:
        raise Inexact("varying texture coordinates")
    x, y, _ = field.constant
    if node.operation in {"ADD", "SUBTRACT"}:
        sign = 1.0 if node.operation == "ADD" else -1.0
        return (1.0, 0.0, sign * x, 0.0, 1.0, sign * y)
    if node.operation == "DIVIDE":
        x, y = (1.0 / v if v else 0.0 for v in (x, y))
    return (x, 0.0, 0.0, 0.0, y, 0.0)


def _mapping(ev, scope, node):
    values = {}
    for name in ("Location", "Rotation", "Scale"):
        socket = next((s for s in node.inputs if s.name == name), None)
        field = ev.socket(scope, socket) if socket is not None else None
        if field is not None and not field.is_constant:
            raise Inexact("varying texture coordinates")
        values[name] = np.array(field.constant if field is not None else (0.0, 0.0, 0.0))
    rotation, scale = _euler(values["Rotation"]), values["Scale"]
    location = values["Location"] if node.vector_type in {"POINT", "TEXTURE"} else np.zeros(3)
    if node.vector_type == "TEXTURE":
        linear = np.diag([1.0 / s if s else 0.0 for s in scale]) @ rotation.T
        offset = -linear @ location
    elif node.vector_type == "NORMAL":
        raise Inexact("mapping of type normal")
    else:
        linear, offset = rotation @ np.diag(scale), location
    return (*linear[0, :2], offset[0], *linear[1, :2], offset[1])


def _euler(angles):
    """Rotation matrix of XYZ Euler angles, as Blender and Cycles order them."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(angles), np.sin(angles)
    x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return z @ y @ x
