# SPDX-License-Identifier: GPL-3.0-or-later
"""The snapshot's material table: compiled once, written once per set of mesh layers."""

from .evaluate import Evaluator
from .surface import compile_surface, default_surface
from .values import IDENTITY, Inexact


class MaterialTable:
    """Compiles materials on demand and gives out snapshot ids."""

    def __init__(self, store, warnings, baker):
        """baker(owner, material) -> fallback for Evaluator, see cycles_bake.SocketBaker;
        materials are original data-blocks, which carry animated values too."""
        self.store, self.warnings, self.baker = store, warnings, baker
        self._shared, self._ids, self.items = {}, {}, []

    def material_id(self, material, owner):
        """Id of a Blender material (None: the default) for an owner, a mesh.Placed."""
        key, surface = self._surface(material, owner)
        record = MaterialRecord(self, surface, owner.mesh).build()
        name = (key, str(record))
        if name not in self._ids:
            self._ids[name] = len(self.items)
            self.items.append(record)
        return self._ids[name]

    def emits(self, material_id):
        """Whether a material of the snapshot glows."""
        return any(closure["type"] == "emission" for closure in self.items[material_id]["closures"])

    def _surface(self, material, owner):
        """(key, Surface); materials that no texture expresses are baked per owner."""
        if material is None:
            return "default", default_surface()
        key = material.name_full
        if key not in self._shared:
            try:
                self._shared[key] = compile_surface(material, Evaluator(self.store, self._warner(key)))
            except Inexact:
                self._shared[key] = None
        if self._shared[key] is not None:
            return key, self._shared[key]
        fallback = self.baker(owner, material)
        evaluator = Evaluator(self.store, self._warner(key), fallback)
        return (key, owner.bake_key), compile_surface(material, evaluator)

    def _warner(self, name):
        return lambda text: self.warnings.add(name, text)


class MaterialRecord:
    """A surface as snapshot JSON, its layer names turned into indices of one mesh."""

    def __init__(self, table, surface, mesh):
        self.table, self.surface, self.mesh = table, surface, mesh

    def build(self):
        """The material's dict."""
        return {
            "name": self.surface.name,
            "one_sided": self.surface.one_sided,
            "closures": [self._closure(c) for c in self.surface.closures],
        }

    def _closure(self, closure):
        record = {"type": closure.type, "color": self._input(closure.color)}
        for name, weight in zip(("weight_a", "weight_b"), closure.weights):
            record[name] = self._input(weight)
        if closure.type == "emission":
            record["strength"] = self._input(closure.strength)
        if closure.type == "principled":
            record.update(
                metallic=self._input(closure.metallic),
                specular=closure.specular,
                roughness=self._input(closure.roughness),
            )
        return record

    def _input(self, field):
        if field.is_constant:
            return {"value": list(field.constant)}
        value, record = list(field.value), {}
        if field.texture is not None:
            value = self._texture(field, value, record)
        if field.color is not None:
            index = self.mesh.color_index(field.color)
            if index is None:
                self._warn(
                    f"colour attribute '{field.color}' is missing: black is used"
                    if field.color
                    else "there is no colour attribute: black is used"
                )
                value = [0.0, 0.0, 0.0]
            else:
                record["color_layer"] = index
        record["value"] = value
        if field.channel != "rgb":
            record["channel"] = field.channel
        if field.invert:
            record["invert"] = True
        return record

    def _texture(self, field, value, record):
        sampler = field.sampler
        layer = self.mesh.uv_index(sampler.uv)
        if layer is None:
            # Blender reads (0, 0) where the layer is missing.
            self._warn(f"UV map '{sampler.uv}' is missing" if sampler.uv else "there is no UV map")
            texel = self.table.store.lookup(field.texture, sampler, (0.0, 0.0))
            picked = texel[:3] if field.channel == "rgb" else (texel["rgba".index(field.channel)],) * 3
            return [float(v * t) for v, t in zip(value, picked)]
        record.update(texture=self.table.store.index(field.texture, sampler), uv_layer=layer)
        if sampler.transform != IDENTITY:
            record["uv_transform"] = [float(v) for v in sampler.transform]
        return value

    def _warn(self, text):
        self.table.warnings.add(self.mesh.name, f"{text} (material '{self.surface.name}')")
