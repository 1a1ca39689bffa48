# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader trees as sums of closures (see ajar_closure)."""

from dataclasses import dataclass, field, replace

from .compat import rec709
from .tree import active_output, find_input, resolve
from .values import ONE, ZERO, Inexact, apply, constant, inverted, multiply, scale

MAX_CLOSURES = 8
DEFAULT_GREY = 0.8  # what Blender shows on surfaces without a material
GLASS = "is approximated as straight transparency"
_DIFFUSE_LIKE = {
    "ShaderNodeBsdfDiffuse": None,
    "ShaderNodeBsdfGlossy": None,
    "ShaderNodeBsdfAnisotropic": None,
    "ShaderNodeBsdfTranslucent": "Translucent BSDF reflects instead of letting light through",
    "ShaderNodeSubsurfaceScattering": "Subsurface Scattering is taken as diffuse",
    "ShaderNodeBsdfToon": "Toon BSDF is taken as diffuse",
    "ShaderNodeBsdfVelvet": "Velvet BSDF is taken as diffuse",
    "ShaderNodeBsdfSheen": "Sheen BSDF is taken as diffuse",
    "ShaderNodeBsdfHair": "Hair BSDF is taken as diffuse",
}


@dataclass
class Closure:
    """One term; the product of weights (scalar fields) is its weight."""

    type: str
    color: object = ONE
    weights: tuple = ()
    strength: object = ONE
    metallic: object = ZERO
    roughness: object = constant(0.5)
    specular: float = 0.5


@dataclass
class Surface:
    """A compiled material. exact: nothing was baked for one object only."""

    name: str
    closures: list = field(default_factory=list)
    one_sided: bool = False


def default_surface(name="default"):
    """Blender's surface where no material is assigned."""
    return Surface(name, [Closure("diffuse", constant(DEFAULT_GREY))])


def compile_surface(material, evaluator):
    """Surface of a material; raises Inexact if the evaluator has no fallback."""
    one_sided = bool(getattr(material, "use_backface_culling", False))
    if not material.use_nodes or material.node_tree is None:
        color = constant(rec709(material.diffuse_color))
        return Surface(material.name, [Closure("diffuse", color)], one_sided)
    output = active_output(material.node_tree, "ShaderNodeOutputMaterial")
    if output is None:
        evaluator.warn("has no Material Output for Cycles: it renders black")
        return Surface(material.name, [], one_sided)
    if (
        find_input(output, "Volume") is not None
        and resolve((), find_input(output, "Volume")).node is not None
    ):
        evaluator.warn("its volume is not simulated")
    closures = _Compiler(evaluator).shader((), find_input(output, "Surface"), ())
    return Surface(material.name, _limit(closures, evaluator), one_sided)


def _limit(closures, ev):
    closures = [_settle(c, ev) for c in closures]
    closures = [c for c in closures if c is not None]
    if len(closures) > MAX_CLOSURES:
        ev.warn(f"has {len(closures)} closures; only the first {MAX_CLOSURES} are kept")
    return closures[:MAX_CLOSURES]


def _settle(closure, ev):
    """The closure with at most two weights, None if it adds nothing."""
    if closure.color.is_zero and closure.type != "principled":
        return None
    if closure.type == "emission" and closure.strength.is_zero:
        return None
    number, varying = 1.0, []
    for weight in closure.weights:
        if weight.is_constant:
            number *= min(max(weight.constant[0], 0.0), 1.0)
        else:
            varying.append(weight)
    if number == 0.0:
        return None
    while len(varying) + (number != 1.0) > 2:
        varying = _merge(varying, ev)
    weights = ([constant(number)] if number != 1.0 else []) + varying
    return replace(closure, weights=tuple(weights))


def _merge(weights, ev):
    """Multiplies two varying weights into one, or replaces one by its mean with a warning."""
    for i, first in enumerate(weights):
        for second in weights[i + 1 :]:
            try:
                product = multiply(ev.store, first, second)
            except Inexact:
                continue
            return [w for w in weights if w is not first and w is not second] + [product]
    last = weights[-1]
    mean = 0.5 if last.texture is None else _mean(last, ev)
    ev.warn("mixes more textures than fit a closure; one mix factor is replaced by its mean")
    return weights[:-2] + [scale(ev.store, weights[-2], (mean,) * 3)]


def _mean(weight, ev):
    value = ev.store.mean(weight.texture, weight.channel)[0] * weight.value[0]
    return 1.0 - value if weight.invert else value


class _Compiler:
    """Turns the shader linked to a socket into closures."""

    def __init__(self, evaluator):
        self.ev = evaluator

    def shader(self, scope, socket, weights):
        """Closures of a shader input socket; nothing linked gives none (black)."""
        source = resolve(scope, socket)
        if source.node is None:
            return []
        node, scope = source.node, source.scope
        name = node.bl_idname
        if name == "ShaderNodeMixShader":
            return self._mix(scope, node, weights)
        if name == "ShaderNodeAddShader":
            return self.shader(scope, node.inputs[0], weights) + self.shader(scope, node.inputs[1], weights)
        if name in _DIFFUSE_LIKE:
            return self._diffuse(scope, node, weights)
        function = getattr(self, "_" + name.removeprefix("ShaderNode").lower(), None)
        if function is not None:
            return function(scope, node, weights)
        self.ev.warn(f"shader node {node.bl_label or name} is not supported; it reflects nothing")
        return []

    def _mix(self, scope, node, weights):
        factor = self.ev.scalar(scope, node, "Fac", "Factor", default=0.5)
        first = self.shader(scope, node.inputs[1], weights + (inverted(factor),)) if factor != ONE else []
        second = self.shader(scope, node.inputs[2], weights + (factor,)) if factor != ZERO else []
        return first + second

    def _diffuse(self, scope, node, weights):
        warning = _DIFFUSE_LIKE[node.bl_idname]
        if warning:
            self.ev.warn(warning)
        return [Closure("diffuse", self.ev.color(scope, node, "Color", default=(0.8,) * 3), weights)]

    def _bsdfmetallic(self, scope, node, weights):
        return [Closure("diffuse", self.ev.color(scope, node, "Base Color"), weights)]

    def _emission(self, scope, node, weights):
        return [
            Closure(
                "emission",
                self.ev.color(scope, node, "Color"),
                weights,
                self.ev.scalar(scope, node, "Strength", default=1.0),
            )
        ]

    def _bsdftransparent(self, scope, node, weights):
        return [Closure("transparent", self.ev.color(scope, node, "Color"), weights)]

    def _bsdfglass(self, scope, node, weights):
        self.ev.warn(f"Glass BSDF {GLASS}")
        return self._bsdftransparent(scope, node, weights)

    def _bsdfrefraction(self, scope, node, weights):
        self.ev.warn(f"Refraction BSDF {GLASS}")
        return self._bsdftransparent(scope, node, weights)

    def _holdout(self, scope, node, weights):
        self.ev.warn("Holdout is taken as black")
        return []

    def _eeveespecular(self, scope, node, weights):
        self.ev.warn("Specular BSDF (EEVEE) is taken as diffuse and emission")
        opaque = weights + (inverted(self.ev.scalar(scope, node, "Transparency")),)
        return [
            Closure("diffuse", self.ev.color(scope, node, "Base Color"), opaque),
            Closure("emission", self.ev.color(scope, node, "Emissive Color"), opaque),
        ]

    def _bsdfprincipled(self, scope, node, weights):
        ev = self.ev
        alpha = ev.scalar(scope, node, "Alpha", default=1.0)
        closures = []
        if alpha != ONE:
            closures.append(Closure("transparent", ONE, weights + (inverted(alpha),)))
            weights = weights + (alpha,)
        emission = ev.color(scope, node, "Emission Color", "Emission")
        strength = ev.scalar(scope, node, "Emission Strength", default=1.0)
        if not emission.is_zero and not strength.is_zero:
            closures.append(Closure("emission", emission, weights, strength))
        color, metallic = self._base_color(scope, node), ev.scalar(scope, node, "Metallic")
        transmission = ev.scalar(scope, node, "Transmission Weight", "Transmission")
        if not transmission.is_zero:
            ev.warn(f"transmission {GLASS}")
            clear = self._product(transmission, inverted(metallic))
            closures.append(Closure("transparent", color, weights + (clear,)))
            weights = weights + (inverted(clear),)
        self._note_ignored(scope, node)
        closures.append(
            Closure(
                "principled",
                color,
                weights,
                metallic=metallic,
                roughness=ev.scalar(scope, node, "Roughness", default=0.5),
                specular=self._specular(scope, node),
            )
        )
        return closures

    def _product(self, a, b):
        try:
            return multiply(self.ev.store, a, b)
        except Inexact:
            self.ev.warn("transmission and metallic textures do not combine; metallic is ignored there")
            return a

    def _base_color(self, scope, node):
        """Base colour; before Blender 4 subsurface mixed a colour of its own into it."""
        ev = self.ev
        color = ev.color(scope, node, "Base Color", default=(0.8,) * 3)
        other = find_input(node, "Subsurface Color")
        amount = ev.scalar(scope, node, "Subsurface Weight", "Subsurface")
        if amount.is_zero:
            return color
        ev.warn("subsurface scattering is taken as diffuse")
        if other is None:
            return color
        try:
            return apply(
                ev.store,
                "subsurface",
                lambda a, b, t: a + t * (b - a),
                color,
                ev.color(scope, node, "Subsurface Color"),
                amount,
            )
        except Inexact:
            ev.warn("the subsurface colour is ignored")
            return color

    def _specular(self, scope, node):
        """Blender's 0..1 specular with F0 = 0.08 * specular; newer versions scale F0 of the IOR."""
        try:
            level = self.ev.number(scope, node, "Specular IOR Level", "Specular", default=0.5)
            if find_input(node, "Specular IOR Level") is None:
                return level
            ior = self.ev.number(scope, node, "IOR", default=1.5)
        except Inexact:
            self.ev.warn("a textured specular level is taken as 0.5")
            return 0.5
        return ((ior - 1.0) / (ior + 1.0)) ** 2 * 2.0 * level / 0.08

    def _note_ignored(self, scope, node):
        for names in (("Coat Weight", "Clearcoat"), ("Sheen Weight", "Sheen")):
            socket = find_input(node, *names)
            if socket is not None and (socket.is_linked or socket.default_value > 0.0):
                self.ev.warn(f"{names[1].lower()} is not simulated")
