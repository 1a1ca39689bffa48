# SPDX-License-Identifier: GPL-3.0-or-later
"""Pre-flight list: what stops a bake or will make it look wrong, each with its remedy."""
import os
from dataclasses import dataclass

import bpy

from . import settings
from .apply import record, uvs
from .bridge import library

_SURFACES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}


@dataclass(frozen=True)
class Finding:
    """One line of the list. Errors stop a bake, warnings do not."""

    level: str  # 'ERROR' or 'WARNING'
    culprit: str
    text: str
    remedy: str

    def __str__(self):
        where = f"{self.culprit}: " if self.culprit else ""
        return f"{where}{self.text}. {self.remedy}."


def check_scene(context, output=True):
    """All findings for the scene, errors first. output False leaves the output folder out."""
    scene = context.scene
    objects = [obj for obj in scene.objects if is_baked(obj)]
    findings = [*_engine()]
    if output:
        findings += _output(scene)
    findings += [*_objects(objects), *_lights(scene, objects), *_images(objects), *_elements(scene)]
    findings += _last_layout(scene)
    return sorted(findings, key=lambda finding: finding.level != "ERROR")


def errors(findings):
    """Only the findings that stop a bake."""
    return [finding for finding in findings if finding.level == "ERROR"]


def is_baked(obj):
    """True for a surface that takes part in the bake. Lamps hidden by the preview are no surfaces."""
    return obj.type in _SURFACES and not obj.hide_render and obj.ajar.surface != "IGNORE"


def wants_lightmap(obj):
    """True for an object that gets texels."""
    return obj.type == "MESH" and obj.ajar.surface in ("AUTO", "LIGHTMAP") and len(obj.data.polygons) > 0


def _error(culprit, text, remedy):
    return Finding("ERROR", culprit, text, remedy)


def _warning(culprit, text, remedy):
    return Finding("WARNING", culprit, text, remedy)


def _engine():
    try:
        library.library_path()
    except library.BakeError as problem:
        yield _error("", str(problem), "Install the add-on from its release zip, or build the engine")


def _output(scene):
    folder = scene.ajar.output_dir
    if folder.startswith("//") and not bpy.data.is_saved:
        return [
            _error(
                "",
                "the file is not saved, so its output folder is unknown",
                "Save the file, or set an absolute output folder",
            )
        ]
    package, _report = settings.output_paths(scene)
    return check_folder(os.path.dirname(package), scene)


def check_folder(folder, scene):
    """Findings about an output folder."""
    existing = folder
    while not os.path.exists(existing) and os.path.dirname(existing) != existing:
        existing = os.path.dirname(existing)
    if not os.path.isdir(existing) or not os.access(existing, os.W_OK | os.X_OK):
        return [_error(folder, "the output folder cannot be written", "Choose a folder of your own")]
    package = os.path.join(folder, settings.PACKAGE)
    if not os.path.isdir(package) or not os.listdir(package):
        return []
    try:
        manifest = record.load_json(os.path.join(package, "manifest.json"))
    except ValueError:
        return [
            _error(
                package,
                "holds files that are not a baked package",
                "Choose another output folder, or move them away",
            )
        ]
    del manifest, scene
    return []


def _objects(objects):
    receivers = [obj for obj in objects if wants_lightmap(obj)]
    if not receivers:
        yield _error(
            "",
            "nothing to bake: no mesh that renders gets a lightmap",
            "Add a mesh, make it visible for renders, or set its surface to Lightmap",
        )
    for obj in receivers:
        reason = uvs.refusal(obj.data)
        if reason:
            yield _warning(
                obj.name,
                reason.split(":")[0] + " and gets no lightmap",
                reason.partition(": ")[2].capitalize() or "Make it local",
            )
        if obj.mode == "EDIT":
            yield _error(obj.name, "is in Edit Mode", "Leave Edit Mode")
    for obj in objects:
        determinant = obj.matrix_world.determinant()
        if determinant < 0.0:
            yield _warning(obj.name, "has a negative scale", "Apply the scale and check its normals")
        elif determinant == 0.0:
            yield _warning(obj.name, "has a scale of zero", "Give it a size, or set it to Ignore")
        if obj.type == "MESH" and not obj.data.polygons and not obj.modifiers:
            yield _warning(obj.name, "is an empty mesh", "Delete it, or set its surface to Ignore")


def _lights(scene, objects):
    lamps = [obj for obj in scene.objects if obj.type == "LIGHT" and not _off(obj)]
    if lamps or _sky_lights(scene) or any(_emits(m) for m in _materials(objects)):
        return
    yield _warning(
        "",
        "nothing shines: all lights are off, hidden or have no power, no material "
        "emits, and the sky is black or off",
        "Switch on a light, or set the sky to Baked",
    )


def _off(obj):
    hidden = obj.ajar.saved_hide_render if obj.ajar.preview_hidden else obj.hide_render
    return hidden or obj.ajar.light_role == "OFF" or obj.data.energy <= 0.0 or not any(obj.data.color)


def _sky_lights(scene):
    world = scene.ajar.preview_world or scene.world
    if world is None or world.ajar.sky_role == "OFF":
        return False
    if not world.use_nodes:
        return any(world.color)
    for node in world.node_tree.nodes:
        if node.bl_idname == "ShaderNodeBackground":
            strength, color = node.inputs["Strength"], node.inputs["Color"]
            lit = color.is_linked or any(tuple(color.default_value)[:3])
            if lit and (strength.is_linked or strength.default_value > 0.0):
                return True
    return False


def _materials(objects):
    found = {}
    for obj in objects:
        for index, slot in enumerate(obj.material_slots):
            records = obj.ajar.preview_slots
            shown = slot.material
            if shown and shown.ajar.is_preview and index < len(records):
                shown = shown.ajar.source
            if shown:
                found[shown.name] = shown
    return found.values()


def _emits(material):
    """True if some emission input of the material is linked or not black."""
    if not material.use_nodes:
        return False
    for node in material.node_tree.nodes:
        if node.bl_idname == "ShaderNodeGroup":
            return True  # not looked into: better no warning than a false one
        color = node.inputs.get("Emission Color") or node.inputs.get("Emission")
        if node.bl_idname == "ShaderNodeEmission":
            color = node.inputs["Color"]
        strength = node.inputs.get("Emission Strength") or node.inputs.get("Strength")
        if color is None or color.type != "RGBA":
            continue
        lit = color.is_linked or any(tuple(color.default_value)[:3])
        if lit and (strength is None or strength.is_linked or strength.default_value > 0.0):
            return True
    return False


def _images(objects):
    missing = set()
    for material in _materials(objects):
        for node in material.node_tree.nodes if material.use_nodes else ():
            image = getattr(node, "image", None)
            if image is None or image.source not in {"FILE", "TILED"} or image.packed_file:
                continue
            path = bpy.path.abspath(image.filepath, library=image.library)
            if image.source == "FILE" and not os.path.isfile(path) and image.name not in missing:
                missing.add(image.name)
                yield _warning(
                    image.name,
                    f"image of material {material.name} is missing ({path})",
                    "Use File > External Data > Find Missing Files",
                )


def _elements(scene):
    sets = {entry.name for entry in scene.ajar.light_sets}
    for obj in scene.objects:
        name = obj.ajar.light_set
        if name and name not in sets:
            yield _warning(
                obj.name,
                f"is in light set {name}, which does not exist",
                "Assign it to a set of the scene's list",
            )
        if obj.ajar.open_pose == obj:
            yield _warning(obj.name, "is its own open pose", "Choose the object of the open leaf")


def _last_layout(scene):
    for culprit, text in record.read_record(scene).get("warnings", []):
        if "overlap" in text.lower():
            yield _warning(culprit, text + " (last bake)", "Turn off Keep Lightmap UVs and bake again")
