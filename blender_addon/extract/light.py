# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps in Blender's units (the engine converts them)."""

from math import pi, tan

from .compat import ajar, has, rec709, transform
from .evaluate import Evaluator
from .node_color import blackbody
from .tree import active_output, find_input, resolve
from .values import Inexact

_ROLE = {"PRIMARY": "primary", "STATIC": "static"}
_SHAPES = {"SQUARE": "rectangle", "RECTANGLE": "rectangle", "DISK": "ellipse", "ELLIPSE": "ellipse"}


def extract_light(evaluated, matrix, name, engine, store, warnings):
    """Snapshot dict of an evaluated light object, or None if it is off or gives no light."""
    role = _ROLE.get(ajar(evaluated, "light_role"))
    if role is None or not getattr(evaluated, "visible_diffuse", True):
        return None
    light = evaluated.data
    color, energy = _strength(light, lambda text: warnings.add(name, text), store)
    record = {
        "name": name,
        "role": role,
        "transform": transform(matrix),
        "color": list(color),
        "energy": energy,
        "casts_shadow": _casts_shadow(light, engine),
    }
    record.update(_shape(light))
    if getattr(light, "normalize", True) is False:
        record["energy"] *= _emitting_area(record)
    return record


def _shape(light):
    if light.type == "POINT":
        return {"type": "point", "radius": light.shadow_soft_size}
    if light.type == "SPOT":
        return {
            "type": "spot",
            "radius": light.shadow_soft_size,
            "spot_angle": light.spot_size,
            "spot_blend": light.spot_blend,
        }
    if light.type == "SUN":
        return {"type": "sun", "sun_angle": light.angle}
    square = light.shape in {"SQUARE", "DISK"}
    return {
        "type": _SHAPES[light.shape],
        "size_x": light.size,
        "size_y": light.size if square else light.size_y,
        "spread": getattr(light, "spread", pi),
    }


def _emitting_area(record):
    """Area that Blender divides the energy by unless 'normalize' is off, m^2 (sr-like for suns)."""
    if record["type"] in {"point", "spot"}:
        radius = record["radius"]
        return pi * radius * radius if radius > 0.0 else 1.0
    if record["type"] == "sun":
        return pi * tan(record["sun_angle"] / 2) ** 2 or 1.0
    area = record["size_x"] * record["size_y"]
    return area * (pi / 4 if record["type"] == "ellipse" else 1.0)


def _casts_shadow(light, engine):
    """The shadow switch of the render engine in use: Cycles has had one of its own."""
    cycles = getattr(light, "cycles", None)
    if engine == "CYCLES" and cycles is not None and has(cycles, "cast_shadow"):
        return bool(cycles.cast_shadow)
    return bool(getattr(light, "use_shadow", True))


def _strength(light, warn, store):
    """(Rec.709 colour, energy in W or W/m^2), with exposure, temperature and light nodes."""
    color, energy = rec709(light.color), float(light.energy)
    if has(light, "exposure"):
        energy *= 2.0**light.exposure
    if getattr(light, "use_temperature", False):
        tint = (
            rec709(light.temperature_color)
            if has(light, "temperature_color")
            else blackbody(light.temperature)
        )
        color = tuple(a * b for a, b in zip(color, tint))
    if light.use_nodes and light.node_tree is not None:
        factor = _nodes(light, warn, store)
        color = tuple(a * b for a, b in zip(color, factor))
    return color, energy


def _nodes(light, warn, store):
    """RGB factor of a light's node tree; what is not constant is left out with a warning."""
    output = active_output(light.node_tree, "ShaderNodeOutputLight")
    source = resolve((), find_input(output, "Surface")) if output is not None else None
    if source is None or source.node is None:
        return (0.0, 0.0, 0.0)
    if source.node.bl_idname != "ShaderNodeEmission":
        warn(f"light node {source.node.bl_label} is not simulated: the lamp's own colour is used")
        return (1.0, 1.0, 1.0)
    return tuple(c * s for c, s in zip(_color(source, warn, store), _emission_strength(source, warn, store)))


def _color(source, warn, store):
    return _constant(source, "Color", lambda ev: ev.color(source.scope, source.node, "Color"), warn, store)


def _emission_strength(source, warn, store):
    socket = find_input(source.node, "Strength")
    origin = resolve(source.scope, socket)
    falloff = origin.node is not None and origin.node.bl_idname == "ShaderNodeLightFalloff"
    if not falloff:
        return _constant(
            source, "Strength", lambda ev: ev.scalar(source.scope, source.node, "Strength"), warn, store
        )
    smooth = find_input(origin.node, "Smooth")
    if origin.socket.name != "Quadratic" or smooth.is_linked or smooth.default_value != 0.0:
        warn("light falloff is taken as quadratic and not smoothed")
    return _constant(
        source, "Strength", lambda ev: ev.scalar(origin.scope, origin.node, "Strength"), warn, store
    )


def _constant(source, what, evaluate, warn, store):
    try:
        field = evaluate(Evaluator(store, warn))
    except Inexact as reason:
        warn(f"light node {what.lower()} is not simulated ({reason}): 1 is used")
        return (1.0, 1.0, 1.0)
    if not field.is_constant:
        warn(f"light node {what.lower()} varies and is not simulated: 1 is used")
        return (1.0, 1.0, 1.0)
    return field.constant
