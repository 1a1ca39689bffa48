# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a shader node tree as three colours: reflectance, emission, transmittance.

The artist's own sockets are reused, so textures and colour ramps keep working; only closures are
replaced. Reflectance is the total hemispherical one that the bake uses (diffuse and specular).
"""
from .expression import ONE, ZERO, Expression, is_constant

# GGX albedo F0 * A(r) + B(r) and its mean A + B, highest power first, |error| <= 0.002.
_ALBEDO_A = (1.4682, -2.658, 0.6845, -0.0389, 0.9514)
_ALBEDO_B = (-0.2456, 0.6084, -0.4619, 0.0561, 0.0456)
_COLOR_ONLY = {  # the bake takes these as diffuse, too
    "ShaderNodeBsdfDiffuse",
    "ShaderNodeBsdfTranslucent",
    "ShaderNodeSubsurfaceScattering",
    "ShaderNodeBsdfToon",
    "ShaderNodeBsdfVelvet",
    "ShaderNodeBsdfSheen",
    "ShaderNodeBsdfHair",
    "ShaderNodeBsdfGlossy",
    "ShaderNodeBsdfAnisotropic",
    "ShaderNodeBsdfMetallic",
}
_CLEAR = {"ShaderNodeBsdfGlass", "ShaderNodeBsdfRefraction", "ShaderNodeBsdfTransparent"}


class Surface:
    """What a closure does to light. normal is the socket feeding its Normal input, or None."""

    def __init__(self, albedo=ZERO, emission=ZERO, transmittance=ZERO, normal=None):
        self.albedo = albedo
        self.emission = emission
        self.transmittance = transmittance
        self.normal = normal


class ClosureReader:
    """Turns the closure that ends in a socket into a Surface, adding value nodes to its tree."""

    def __init__(self, tree, expand_group=None):
        self.tree = tree
        self.expression = Expression(tree)
        self.unknown = []
        self._expand_group = expand_group

    def read(self, socket):
        """Surface of the closure linked to a shader input socket; nothing linked is black."""
        source = _source(socket)
        if source is None:
            return Surface()
        node = source.node
        kind = node.bl_idname
        if kind == "ShaderNodeMixShader":
            return self._mix(node)
        if kind == "ShaderNodeAddShader":
            return self._add(node)
        if kind == "ShaderNodeGroup" and self._expand_group and node.node_tree:
            return self._expand_group(self, node, source)
        return self._closure(node, kind)

    def value(self, node, *names, default=0.0):
        """First of the named inputs as a value: its source socket, or its constant."""
        for name in names:
            socket = node.inputs.get(name)
            if socket is not None:
                return self.socket_value(socket)
        return default

    def socket_value(self, socket):
        """An input socket as a value."""
        source = _source(socket)
        if source is not None:
            return self.expression.scalar(source) if socket.type == "VALUE" else source
        plain = socket.default_value
        return float(plain) if socket.type == "VALUE" else tuple(plain)[:3]

    def _closure(self, node, kind):
        if kind == "ShaderNodeBsdfPrincipled":
            return self._principled(node)
        if kind in ("ShaderNodeEmission", "ShaderNodeBackground"):
            strength = self.value(node, "Strength")
            return Surface(emission=self.expression.multiply(self.value(node, "Color"), strength))
        if kind in _COLOR_ONLY:
            return Surface(self.value(node, "Color", "Base Color"), normal=_normal(node))
        if kind == "ShaderNodeEeveeSpecular":
            return self._eevee_specular(node)
        if kind in _CLEAR:
            return Surface(transmittance=self.value(node, "Color"))
        if kind != "ShaderNodeHoldout":
            self.unknown.append(node.bl_label or node.name)
        return Surface()

    def _mix(self, node):
        factor = self.socket_value(node.inputs[0])
        if is_constant(factor) and factor <= 0.0:
            return self.read(node.inputs[1])
        if is_constant(factor) and factor >= 1.0:
            return self.read(node.inputs[2])
        a, b = self.read(node.inputs[1]), self.read(node.inputs[2])
        mix = self.expression.mix
        return Surface(
            mix(factor, a.albedo, b.albedo),
            mix(factor, a.emission, b.emission),
            mix(factor, a.transmittance, b.transmittance),
            a.normal or b.normal,
        )

    def _add(self, node):
        a, b = self.read(node.inputs[0]), self.read(node.inputs[1])
        add = self.expression.add
        return Surface(
            add(a.albedo, b.albedo),
            add(a.emission, b.emission),
            add(a.transmittance, b.transmittance),
            a.normal or b.normal,
        )

    def _specular(self, f0, roughness):
        """GGX albedo with the energy of multiple scattering put back."""
        math = self.expression
        a, b = math.polynomial(_ALBEDO_A, roughness), math.polynomial(_ALBEDO_B, roughness)
        single = math.add(math.multiply(f0, a), b)
        mean = math.add(a, b)
        lost = math.divide(math.one_minus(mean), mean)
        return math.minimum(math.multiply(single, math.add(1.0, math.multiply(f0, lost))), ONE)

    def _eevee_specular(self, node):
        math = self.expression
        clear = self.value(node, "Transparency")
        opaque = math.one_minus(clear)
        return Surface(
            math.multiply(self.value(node, "Base Color"), opaque),
            math.multiply(self.value(node, "Emissive Color", default=ZERO), opaque),
            clear,
            _normal(node),
        )

    def _base_color(self, node):
        """Base colour; before Blender 4 subsurface mixed a colour of its own into it."""
        base = self.value(node, "Base Color")
        if "Subsurface Color" not in node.inputs:
            return base
        return self.expression.mix(self.value(node, "Subsurface"), base, self.value(node, "Subsurface Color"))

    def _dielectric_f0(self, node):
        """0.08 * specular; newer versions scale the F0 of the refractive index by twice the level."""
        math = self.expression
        if "Specular IOR Level" not in node.inputs:
            return math.multiply(self.value(node, "Specular", default=0.5), 0.08)
        ior = node.inputs["IOR"].default_value
        return math.multiply(self.value(node, "Specular IOR Level"), 2.0 * ((ior - 1.0) / (ior + 1.0)) ** 2)

    def _principled(self, node):
        """Clear parts (alpha, transmission) let light through; the rest reflects."""
        math = self.expression
        base = self._base_color(node)
        roughness = self.value(node, "Roughness")
        metallic = self.value(node, "Metallic")
        specular = self._specular(self._dielectric_f0(node), roughness)
        albedo = math.add(specular, math.multiply(base, math.one_minus(specular)))
        if not is_constant(metallic) or metallic != 0.0:
            albedo = math.mix(metallic, albedo, self._specular(base, roughness))
        strength = self.value(node, "Emission Strength", default=1.0)
        emission = math.multiply(self.value(node, "Emission Color", "Emission", default=ZERO), strength)
        alpha = self.value(node, "Alpha", default=1.0)
        clear = math.multiply(
            self.value(node, "Transmission Weight", "Transmission"), math.one_minus(metallic)
        )
        albedo = math.multiply(albedo, math.one_minus(clear))
        through = math.add(math.multiply(math.multiply(base, clear), alpha), math.one_minus(alpha))
        return Surface(math.multiply(albedo, alpha), math.multiply(emission, alpha), through, _normal(node))


def _normal(node):
    socket = node.inputs.get("Normal")
    return _source(socket) if socket is not None else None


def _source(socket):
    """The output socket that feeds an input, seen through reroutes and muted nodes."""
    while socket is not None and socket.is_linked:
        link = socket.links[0]
        if getattr(link, "is_muted", False) or not link.is_valid:
            return None
        source = link.from_socket
        node = source.node
        if node.bl_idname == "NodeReroute":
            socket = node.inputs[0]
        elif node.mute:
            inner = [link.from_socket for link in node.internal_links if link.to_socket == source]
            socket = inner[0] if inner else None
        else:
            return source
    return None
