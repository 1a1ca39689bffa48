# SPDX-License-Identifier: GPL-3.0-or-later
"""Pre-flight list: what stops a bake or will make it look wrong, each with its remedy."""
import os

import bpy

from . import checks_elements, settings
from .apply import record, uvs
from .bridge import library
from .findings import error, warning
from .shine import emits, hidden, materials

_SURFACES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}


def check_scene(context, output=True):
    """All findings for the scene, errors first. output False leaves the output folder out."""
    scene = context.scene
    objects = [obj for obj in scene.objects if is_baked(obj)]
    findings = [*_engine()]
    if output:
        findings += _output(scene)
    findings += [
        *_objects(objects),
        *_lights(scene, objects),
        *_images(objects),
        *checks_elements.check(context),
    ]
    findings += [*_last_layout(scene), *_last_sides(scene)]
    return sorted(findings, key=lambda finding: finding.level != "ERROR")


def errors(findings):
    """Only the findings that stop a bake."""
    return [finding for finding in findings if finding.level == "ERROR"]


def is_baked(obj):
    """True for a surface that takes part in the bake."""
    return obj.type in _SURFACES and not hidden(obj) and obj.ajar.surface != "IGNORE"


def wants_lightmap(obj):
    """True for an object that gets texels."""
    return obj.type == "MESH" and obj.ajar.surface in ("AUTO", "LIGHTMAP") and len(obj.data.polygons) > 0


def _engine():
    try:
        library.library_path()
    except library.BakeError as problem:
        yield error("", str(problem), "Install the add-on from its release zip, or build the engine")


def _output(scene):
    folder = scene.ajar.output_dir
    if folder.startswith("//") and not bpy.data.is_saved:
        return [
            error(
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
        return [error(folder, "the output folder cannot be written", "Choose a folder of your own")]
    package = os.path.join(folder, settings.PACKAGE)
    if not os.path.isdir(package) or not os.listdir(package):
        return []
    try:
        manifest = record.load_json(os.path.join(package, "manifest.json"))
    except ValueError:
        return [
            error(
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
        yield error(
            "",
            "nothing to bake: no mesh that renders gets a lightmap",
            "Add a mesh, make it visible for renders, or set its surface to Lightmap",
        )
    for obj in receivers:
        reason = uvs.refusal(obj.data)
        if reason:
            yield warning(
                obj.name,
                reason.split(":")[0] + " and gets no lightmap",
                reason.partition(": ")[2].capitalize() or "Make it local",
            )
        if obj.mode == "EDIT":
            yield error(obj.name, "is in Edit Mode", "Leave Edit Mode")
    for obj in objects:
        determinant = obj.matrix_world.determinant()
        if determinant < 0.0:
            yield warning(obj.name, "has a negative scale", "Apply the scale and check its normals")
        elif determinant == 0.0:
            yield warning(obj.name, "has a scale of zero", "Give it a size, or set it to Ignore")
        if obj.type == "MESH" and not obj.data.polygons and not obj.modifiers:
            yield warning(obj.name, "is an empty mesh", "Delete it, or set its surface to Ignore")


def _lights(scene, objects):
    lamps = [obj for obj in scene.objects if obj.type == "LIGHT" and not _off(obj)]
    if lamps or _sky_lights(scene) or any(emits(m) for m in materials(objects)):
        return
    yield warning(
        "",
        "nothing shines: all lights are off, hidden or have no power, no material "
        "emits, and the sky is black or off",
        "Switch on a light, or set the sky to Baked",
    )


def _off(obj):
    return hidden(obj) or obj.ajar.light_role == "OFF" or obj.data.energy <= 0.0 or not any(obj.data.color)


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


def _images(objects):
    missing = set()
    for material in materials(objects):
        for node in material.node_tree.nodes if material.use_nodes else ():
            image = getattr(node, "image", None)
            if image is None or image.source not in {"FILE", "TILED"} or image.packed_file:
                continue
            path = bpy.path.abspath(image.filepath, library=image.library)
            if image.source == "FILE" and not os.path.isfile(path) and image.name not in missing:
                missing.add(image.name)
                yield warning(
                    image.name,
                    f"image of material {material.name} is missing ({path})",
                    "Use File > External Data > Find Missing Files",
                )


def _last_layout(scene):
    for culprit, text in record.read_record(scene).get("warnings", []):
        if "overlap" in text.lower():
            yield warning(culprit, text + " (last bake)", "Turn off Keep Lightmap UVs and bake again")


def _flipped_findings(scene):
    """(culprit, problem, remedy) of what the last bake found to look flipped."""
    for culprit, text in record.read_record(scene).get("warnings", []):
        problem, mark, remedy = text.partition(". Flip ")
        if mark and "flipped" in problem:
            yield culprit, problem, remedy


def flipped_objects(scene):
    """Mesh objects that the last bake found to look flipped, each with whether it does as a whole. What was set to
    Back since then is left out."""
    found = {}
    for culprit, problem, remedy in _flipped_findings(scene):
        grouped = problem.partition(" more objects look flipped, in part or whole: ")[2]
        for name in grouped.split(", ") if grouped else [culprit]:
            obj = scene.objects.get(name)
            if obj is not None and obj.type == "MESH" and obj.ajar.bake_side == "FRONT":
                found[obj] = not grouped and remedy.startswith("its normals")
    return found


def _last_sides(scene):
    """Objects that the last bake found to look flipped. What was set to Back since then is left out."""
    for culprit, problem, remedy in _flipped_findings(scene):
        obj = scene.objects.get(culprit)
        if obj is None or obj.ajar.bake_side == "FRONT":
            yield warning(culprit, problem + " (last bake)", "Flip " + remedy)
