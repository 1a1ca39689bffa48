# SPDX-License-Identifier: GPL-3.0-or-later
"""Extraction of meshes, materials and textures.

    blender -b --factory-startup --python-exit-code 1 -P tests/blender/bl_extract.py [-- NAME...]
"""
import math
import os
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import bpy
import numpy as np

from support.extract_kit import *  # noqa: F401,F403 - the words these tests are written in
from support.extract_kit import run


def test_layers_and_normals():
    mesh = quad_mesh("Layers")
    mesh.uv_layers.new(name="Second")
    byte = mesh.color_attributes.new("Byte", "BYTE_COLOR", "CORNER")
    for item in byte.data:
        item.color = (0.5, 0.25, 1.0, 1.0)
    point = mesh.color_attributes.new("Point", "FLOAT_COLOR", "POINT")
    point.data[2].color = (3.0, 0.0, 0.5, 1.0)
    obj = add("Layers", mesh, scale=(-2.0, 1.0, 0.0))
    shot = Shot()
    read = shot.mesh("Layers")
    assert read["uv_layer_names"] == ["UVMap", "Second"] and read["triangle_count"] == 2
    assert read["corner_normals"] is None, "all faces are flat"
    close(read["uv_layers"][0], read["positions"][read["corner_vertex"]][..., :2])
    colors = dict(zip(read["color_layer_names"], read["color_layers"]))
    close(colors["Byte"][0, 0], (0.5, 0.25, 1.0, 1.0), 0.01)
    corner = read["corner_vertex"] == 2
    close(colors["Point"][corner][0], (3.0, 0.0, 0.5, 1.0))
    close(shot.instance("Layers")["transform"], np.array(obj.matrix_world)[:3].reshape(-1))
    assert value(shot.closures("Layers")[0]["color"]) == [0.8] * 3, "no material is Blender's grey"


def test_smooth_and_sharp():
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    cube.name = "Smooth"
    for polygon in cube.data.polygons:
        polygon.use_smooth = polygon.index != 0
    shot = Shot()
    read = shot.mesh("Smooth")
    corners = read["positions"][read["corner_vertex"]]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    face /= np.linalg.norm(face, axis=1, keepdims=True)
    flat = np.abs((read["corner_normals"] * face[:, None]).sum(-1) - 1).max(-1) < 1e-5
    assert flat.sum() == 2, "the one flat face has two triangles"
    smooth = read["corner_normals"][~flat].reshape(-1, 3)
    close(np.abs(smooth), 1 / math.sqrt(3), 1e-3)


def test_objects():
    mesh = quad_mesh("Shared")
    add("A", mesh)
    add("B", mesh, location=(5, 0, 0))
    add("Hidden", mesh, hide_render=True)
    add("Unseen", mesh, hide_viewport=True)
    add("NoShadow", mesh, visible_shadow=False)
    mirrored = quad("Mirrored")
    mirrored.modifiers.new("Mirror", "MIRROR")
    refined = quad("Refined")
    modifier = refined.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels, modifier.subdivision_type = 0, 2, "SIMPLE"
    add("Empty mesh", bpy.data.meshes.new("Empty mesh"))
    bpy.ops.object.text_add()
    bpy.context.object.name = "Text"
    eye = quad("Eye")
    eye.hide_set(True)
    library = bpy.data.collections.new("Library")
    library.objects.link(bpy.data.objects.new("Part", quad_mesh("Part")))
    sign = bpy.data.curves.new("Sign", "FONT")
    sign.body = "I"
    library.objects.link(bpy.data.objects.new("Sign", sign))
    add("Instancer", None, instance_type="COLLECTION", instance_collection=library)
    secret = bpy.data.collections.new("Secret")
    bpy.context.scene.collection.children.link(secret)
    secret.hide_render = True
    secret.objects.link(bpy.data.objects.new("InSecret", mesh))
    request, mapping = layout_request()
    assert ("Shared", ["A", "B", "NoShadow", "Unseen"]) in mapping.meshes, mapping.meshes
    places = {"A": place(0.5), "Mirrored": place(1), "Refined": place(1), "Unseen": place(1)}
    for name in ("Shared", "Refined", "Mirrored"):
        lightmap_layer(bpy.data.meshes[name])
    for name in ("A", "B"):
        bpy.data.objects[name].ajar.bake_side = "BACK"
    shot = Shot({"pages": [{"width": 64, "height": 64}], "objects": places})
    names = [i["name"] for i in shot.data["instances"]]
    assert not {"Hidden", "InSecret", "Empty mesh"} & set(names), names
    assert {"Unseen", "Eye", "Text"} <= set(names), names
    assert sum("Text" in n for n in names) == 1 and sum("Sign" in n for n in names) == 1, names
    assert shot.instance("A")["mesh"] == shot.instance("B")["mesh"] == shot.instance("Unseen")["mesh"]
    assert shot.instance("A")["surface"] == "lightmap" and shot.instance("A")["lightmap_layer"] == 1
    assert shot.instance("A")["uv_scale"] == [0.5, 0.5] and shot.instance("A")["bake_side"] == "back"
    assert "bake_side" not in shot.instance("B"), "what stores no light has no side to choose"
    assert "bake_side" not in shot.instance("Unseen")
    assert shot.instance("B")["surface"] == "occluder" and shot.warned("B", "no lightmap UVs")
    assert shot.instance("NoShadow")["visibility"] == ["gather"]
    assert shot.instance("Mirrored")["surface"] == "occluder" and shot.warned("Mirrored", "'Mirror'")
    assert shot.instance("Refined")["surface"] == "lightmap"
    assert shot.mesh("Refined")["triangle_count"] == 32, "subdivided as a render would be"
    assert shot.warned("Empty mesh", "no faces") and shot.warned("Text", "font")
    assert any(n.startswith("Instancer/Part") for n in names) and shot.warned("Instancer", "'Part'")
    assert eye.hide_get() and bpy.data.objects["Unseen"].hide_viewport and modifier.levels == 0


def place(scale):
    return {"page": 0, "scale": [scale, scale], "offset": [0.0, 0.0]}


def lightmap_layer(mesh):
    layer = mesh.uv_layers.new(name=model.LIGHTMAP_UV)
    for loop in mesh.loops:
        layer.data[loop.index].uv = mesh.vertices[loop.vertex_index].co[:2]


def test_damaged_mesh():
    mesh = quad_mesh("Damaged")
    for polygon in mesh.polygons:
        polygon.use_smooth = True
    mesh.vertices[1].co = (float("nan"), 0, 0)
    add("Damaged", mesh, scale=(0, -1, 1))
    read = Shot().mesh("Damaged")
    assert np.isnan(read["positions"]).sum() == 1
    sound = np.isfinite(read["positions"][read["corner_vertex"]]).all(axis=(1, 2))
    assert np.isfinite(read["corner_normals"][sound]).all()


def test_geometry_nodes():
    """Instances made by geometry nodes: extracted once, placed often."""
    tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    if hasattr(tree, "interface"):
        tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    else:
        tree.outputs.new("NodeSocketGeometry", "Geometry")
    line, cube, place_node = (
        tree.nodes.new("GeometryNode" + k) for k in ("MeshLine", "MeshCube", "InstanceOnPoints")
    )
    leave = tree.nodes.new("NodeGroupOutput")
    tree.links.new(line.outputs[0], place_node.inputs["Points"])
    tree.links.new(cube.outputs[0], place_node.inputs["Instance"])
    tree.links.new(place_node.outputs[0], leave.inputs[0])
    quad("Scatterer").modifiers.new("Nodes", "NODES").node_group = tree
    harmless = bpy.data.node_groups.new("Smooth", "GeometryNodeTree")
    harmless.nodes.new("GeometryNodeSetShadeSmooth")
    objects = importlib.import_module(MODULE + ".extract.objects")
    assert objects.copying_modifiers(bpy.data.objects["Scatterer"]) == ["Nodes"]
    bpy.data.objects["Scatterer"].modifiers[0].node_group = harmless
    assert not objects.copying_modifiers(bpy.data.objects["Scatterer"])
    bpy.data.objects["Scatterer"].modifiers[0].node_group = tree
    shot = Shot()
    cubes = [i for i in shot.data["instances"] if i["name"] != "Scatterer"]
    assert len(cubes) == 10 and len({i["mesh"] for i in cubes}) == 1, shot.data["instances"]
    assert len({i["name"] for i in cubes}) == 10
    assert shot.data["meshes"][cubes[0]["mesh"]]["triangle_count"] == 12


def test_slots():
    mesh = quad_mesh("Slots")
    red, blue = (bpy.data.materials.new(n) for n in ("Red", "Blue"))
    red.diffuse_color, blue.diffuse_color = (1, 0, 0, 1), (0, 0, 1, 1)
    mesh.materials.append(red)
    add("Own", mesh)
    other = add("Other", mesh)
    other.material_slots[0].link = "OBJECT"
    other.material_slots[0].material = blue
    mesh.polygons[0].material_index = 3
    shot = Shot()
    assert shot.material("Own")["name"] == "Red" and shot.material("Other")["name"] == "Blue"
    assert len(shot.instance("Own")["materials"]) == 4, "indices past the slots show the last"
    close(value(shot.closures("Own")[0]["color"]), (1, 0, 0))


def test_layout_request():
    mesh = quad_mesh("Plane")
    mesh.edges[0].use_edge_sharp = True
    add("P1", mesh)
    add("P2", mesh, scale=(-3, 1, 1))
    request, mapping = layout_request()
    assert mapping.meshes == [("Plane", ["P1", "P2"])]
    record = request["meshes"][0]
    assert record["corner_edge_sharp"]["count"] == 4 and record["corner_uv"] is None
    assert record["users"][1]["transform"][0] == -3.0


# ---- materials ------------------------------------------------------------------------------


def test_principled():
    surface(
        "P",
        lambda t: node(
            t, "BsdfPrincipled", {"Base Color": (0.1, 0.2, 0.3, 1), "Metallic": 0.25, "Roughness": 0.6}
        ).outputs[0],
    )
    surface(
        "Glow",
        lambda t: node(
            t,
            "BsdfPrincipled",
            {"Emission": (1, 0.5, 0, 1), "Emission Strength": 4.0}
            if "Emission" in t.nodes.new("ShaderNodeBsdfPrincipled").inputs
            else {"Emission Color": (1, 0.5, 0, 1), "Emission Strength": 4.0},
        ).outputs[0],
    )
    surface("Half", lambda t: node(t, "BsdfPrincipled", {"Alpha": 0.25}).outputs[0])
    shot = Shot()
    (only,) = shot.closures("P")
    close(value(only["color"]), (0.1, 0.2, 0.3))
    assert only["type"] == "principled" and abs(value(only["metallic"])[0] - 0.25) < 1e-6
    assert abs(only["specular"] - 0.5) < 1e-6
    glow = shot.closures("Glow")
    assert [c["type"] for c in glow] == ["emission", "principled"]
    close(value(glow[0]["strength"])[0], 4.0)
    half = shot.closures("Half")
    assert [c["type"] for c in half] == ["transparent", "principled"]
    close(value(half[0]["weight_a"])[0], 0.75)
    close(value(half[1]["weight_a"])[0], 0.25)


def textured(name, shown, shader="BsdfDiffuse"):
    surface(
        name, lambda t: node(t, shader, {"Color": node(t, "TexImage", image=shown).outputs[0]}).outputs[0]
    )


def test_textures():
    coded = image("Coded", checker(), "sRGB")
    data = image("Data", checker(4))
    high = image("High", checker() * 8, "Non-Color", True)
    large = image("Large", np.tile((0.5, 0.5, 0.5, 1.0), (300, 2500, 1)), "sRGB")

    def mapped(tree):
        uv = node(tree, "UVMap", uv_map="UVMap")
        turned = node(
            tree,
            "Mapping",
            {
                "Vector": uv.outputs[0],
                "Location": (1, 2, 0),
                "Rotation": (0, 0, math.pi / 2),
                "Scale": (3, 4, 1),
            },
        )
        texture = node(
            tree,
            "TexImage",
            {"Vector": turned.outputs[0]},
            image=data,
            interpolation="Closest",
            extension="EXTEND",
        )
        tinted = node(
            tree,
            "MixRGB",
            {"Fac": 1.0, "Color1": texture.outputs[0], "Color2": (0.5, 1, 2, 1)},
            blend_type="MULTIPLY",
        )
        return node(tree, "BsdfDiffuse", {"Color": tinted.outputs[0]}).outputs[0]

    surface("Mapped", mapped)
    textured("Plain", coded)
    textured("Float", high, "Emission")
    textured("Shrunk", large)
    lost = bpy.data.images.new("Lost", 4, 4)
    lost.source, lost.filepath = "FILE", "/nowhere/lost.png"
    textured("NoFile", lost)
    shot = Shot()
    color = shot.closures("Mapped")[0]["color"]
    close(color["uv_transform"], (0, -4, 1, 3, 0, 2))
    close(value(color), (0.5, 1, 2))
    texture = shot.data["textures"][color["texture"]]
    assert texture["nearest"] and texture["extend"] == "edge" and texture["color"] == "linear"
    plain = shot.data["textures"][shot.closures("Plain")[0]["color"]["texture"]]
    assert plain["texel"] == "u8" and plain["color"] == "srgb"
    assert plain["texels"][0, 1].tolist() == [255, 0, 0, 255], "bottom row first"
    bright = shot.data["textures"][shot.closures("Float")[0]["color"]["texture"]]
    assert bright["texel"] == "f32" and bright["texels"].max() == 8.0
    shrunk = shot.data["textures"][shot.closures("Shrunk")[0]["color"]["texture"]]
    assert (shrunk["width"], shrunk["height"]) == (1024, 123)
    close(shrunk["texels"][..., :3], 128, 1)
    close(value(shot.closures("NoFile")[0]["color"]), 0.5)
    assert shot.warned("NoFile", "Lost")


def test_mix_and_alpha():
    cutout = image("Cutout", checker(), "sRGB")

    def mixed(tree):
        texture = node(tree, "TexImage", image=cutout)
        solid = node(tree, "BsdfDiffuse", {"Color": texture.outputs[0]})
        return node(
            tree,
            "MixShader",
            {0: texture.outputs["Alpha"], 1: node(tree, "BsdfTransparent").outputs[0], 2: solid.outputs[0]},
        ).outputs[0]

    surface("Fence", mixed)

    def nested(tree):
        texture = node(tree, "TexImage", image=cutout)
        inner = node(
            tree,
            "MixShader",
            {0: 0.25, 1: node(tree, "Emission").outputs[0], 2: node(tree, "BsdfDiffuse").outputs[0]},
        )
        add_shader = node(tree, "AddShader", {0: inner.outputs[0], 1: node(tree, "Emission").outputs[0]})
        return node(tree, "MixShader", {0: texture.outputs[0], 1: add_shader.outputs[0]}).outputs[0]

    surface("Nested", nested)
    shot = Shot()
    clear, solid = shot.closures("Fence")
    assert (
        clear["type"] == "transparent" and clear["weight_a"]["invert"] and clear["weight_a"]["channel"] == "a"
    )
    assert solid["weight_a"]["channel"] == "a" and not solid["weight_a"].get("invert")
    emission, diffuse, extra = shot.closures("Nested")
    close(value(emission["weight_a"])[0], 0.75)
    assert emission["weight_b"]["invert"] and extra["weight_a"]["invert"]
    luminance = shot.data["textures"][emission["weight_b"]["texture"]]
    close(luminance["texels"][0, 1, 0], 0.2126, 1e-4)


def test_vertex_colours_and_groups():
    def colored(tree):
        layer = node(tree, "VertexColor", layer_name="Col")
        texture = node(tree, "TexImage", image=image("Tint", checker()))
        both = node(
            tree,
            "MixRGB",
            {"Fac": 1.0, "Color1": layer.outputs[0], "Color2": texture.outputs[0]},
            blend_type="MULTIPLY",
        )
        return node(tree, "BsdfDiffuse", {"Color": both.outputs[0]}).outputs[0]

    surface("Painted", colored)
    bpy.data.meshes["Painted"].color_attributes.new("Col", "FLOAT_COLOR", "POINT")
    group = bpy.data.node_groups.new("Group", "ShaderNodeTree")
    if hasattr(group, "interface"):
        group.interface.new_socket("Color", in_out="INPUT", socket_type="NodeSocketColor")
        group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    else:
        group.inputs.new("NodeSocketColor", "Color")
        group.outputs.new("NodeSocketShader", "Shader")
    entry, leave = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    reroute = group.nodes.new("NodeReroute")
    group.links.new(entry.outputs[0], reroute.inputs[0])
    group.links.new(node(group, "BsdfDiffuse", {"Color": reroute.outputs[0]}).outputs[0], leave.inputs[0])

    def grouped(tree):
        outer = tree.nodes.new("ShaderNodeGroup")
        outer.node_tree = group
        gamma = node(tree, "Gamma", {"Color": (0.5, 0.25, 1, 1), "Gamma": 2.0})
        muted = node(tree, "Invert", {"Color": gamma.outputs[0]})
        muted.mute = True
        tree.links.new(muted.outputs[0], outer.inputs[0])
        return outer.outputs[0]

    surface("Grouped", grouped)
    shot = Shot()
    color = shot.closures("Painted")[0]["color"]
    assert color["color_layer"] == 0 and color["texture"] is not None
    close(value(shot.closures("Grouped")[0]["color"]), (0.25, 0.0625, 1.0))


def test_ramp_per_texel():
    def ramped(tree):
        texture = node(tree, "TexImage", image=image("Ramped", checker(8)))
        ramp = node(tree, "ValToRGB", {"Fac": texture.outputs[0]})
        ramp.color_ramp.elements[0].color = (1, 0, 0, 1)
        ramp.color_ramp.elements[1].color = (0, 0, 1, 1)
        return node(tree, "BsdfDiffuse", {"Color": ramp.outputs[0]}).outputs[0]

    surface("Ramp", ramped)
    shot = Shot()
    texture = shot.data["textures"][shot.closures("Ramp")[0]["color"]["texture"]]
    luminance = checker(8)[..., :3] @ (0.2126, 0.7152, 0.0722)
    close(texture["texels"][..., 2], luminance, 0.01)
    close(texture["texels"][..., 0], 1 - luminance, 0.01)
    assert all("lightmap" in t for _, t in shot.result.warnings)


def test_blackbody():
    close(color_module.blackbody(6500), (1.05, 0.98, 1.0), 0.05)
    warm = color_module.blackbody(3000)
    close(np.dot(warm, (0.2126, 0.7152, 0.0722)), 1.0, 1e-3)
    close(warm, (1.77, 0.845, 0.26), 0.05)


# ---- what Cycles bakes ------------------------------------------------------------------------


def object_color_material(name, grouped):
    """Diffuse whose colour is the object-space position: no field expresses that."""

    def build(tree):
        target = tree
        if grouped:
            target = bpy.data.node_groups.new("Inner", "ShaderNodeTree")
            if hasattr(target, "interface"):
                target.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
            else:
                target.outputs.new("NodeSocketShader", "Shader")
        place_node = node(target, "TexCoord")
        shader = node(target, "BsdfDiffuse", {"Color": place_node.outputs["Object"]}).outputs[0]
        if not grouped:
            return shader
        leave = target.nodes.new("NodeGroupOutput")
        target.links.new(shader, leave.inputs[0])
        outer = tree.nodes.new("ShaderNodeGroup")
        outer.node_tree = target
        return outer.outputs[0]

    return surface(name, build)


def check_baked(shot, name):
    color = shot.closures(name)[0]["color"]
    texture, mesh = shot.data["textures"][color["texture"]], shot.mesh(name)
    uv = mesh["uv_layers"][color["uv_layer"]].mean(axis=1)
    m = np.array(color.get("uv_transform", (1, 0, 0, 0, 1, 0))).reshape(2, 3)
    u, v = (uv @ m[:, :2].T + m[:, 2]).T
    texels = texture["texels"]
    found = texels[(v * texture["height"]).astype(int), (u * texture["width"]).astype(int), :3]
    center = mesh["positions"][mesh["corner_vertex"]].mean(axis=1)
    close(found[:, :2], center[:, :2], 1.5 / min(texture["width"], texture["height"]) + 0.01)


def test_cycles_bake():
    before = data_counts()
    object_color_material("Cells", False)
    object_color_material("Mapped", True)
    lightmap_layer(bpy.data.meshes["Mapped"])
    made = {k: n - before[k] for k, n in data_counts().items()}
    shot = Shot({"pages": [{"width": 64, "height": 64}], "objects": {"Mapped": place(1)}})
    assert {k: n - before[k] for k, n in data_counts().items()} == made, "temporary data is left"
    check_baked(shot, "Cells")
    check_baked(shot, "Mapped")
    assert shot.warned("Cells", "baked to a texture")
    assert shot.mesh("Cells")["uv_layer_names"] == ["UVMap", "AjarBaked"]


NODE_CASES = {
    "gamma": lambda t: node(t, "Gamma", {"Color": (0.5, 0.2, 1.5, 1), "Gamma": 1.7}),
    "invert": lambda t: node(t, "Invert", {0: 0.3, "Color": (0.5, 0.2, 0.9, 1)}),
    "bright": lambda t: node(
        t, "BrightContrast", {"Color": (0.5, 0.2, 0.9, 1), "Bright": 0.1, "Contrast": 0.4}
    ),
    "hue": lambda t: node(
        t, "HueSaturation", {"Color": (0.5, 0.2, 0.9, 1), "Hue": 0.7, "Saturation": 0.6, "Value": 1.3, 3: 0.8}
    ),
    "blackbody": lambda t: node(t, "Blackbody", {0: 3200.0}),
    "combine": lambda t: node(t, "CombineColor", {0: 0.6, 1: 0.5, 2: 0.7}, mode="HSV"),
    "ramp": lambda t: node(t, "ValToRGB", {0: 0.3}),
    "math": lambda t: node(t, "Math", {0: 0.3, 1: 2.5}, operation="POWER"),
    "range": lambda t: node(t, "MapRange", {"Value": 0.3, 1: 0.1, 2: 0.5, 3: 2.0, 4: 1.0}),
    **{
        f"mix {blend.lower()}": lambda t, blend=blend: node(
            t, "MixRGB", {0: 0.6, 1: (0.2, 0.5, 0.8, 1), 2: (0.7, 0.3, 0.4, 1)}, blend_type=blend
        )
        for blend in (
            "MIX",
            "ADD",
            "MULTIPLY",
            "SCREEN",
            "OVERLAY",
            "DIFFERENCE",
            "DIVIDE",
            "LINEAR_LIGHT",
            "LIGHTEN",
        )
    },
}


def test_nodes_agree_with_cycles():
    """Each node on constants: our evaluation against Cycles' bake of the same socket."""
    materials = {}
    for name, build in NODE_CASES.items():
        materials[name] = surface(
            name, lambda t: node(t, "Emission", {"Color": build(t).outputs[0]}).outputs[0]
        )
    shot = Shot()
    bake = importlib.import_module(MODULE + ".extract.cycles_bake").bake_socket
    wrong = []
    for name, material in materials.items():
        emission = next(n for n in material.node_tree.nodes if n.type == "EMISSION")
        owner = Owner(bpy.data.objects[name], material)
        uv = np.array([[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]], dtype=np.float32)
        baked = bake(
            owner, material, (emission.name, emission.inputs["Color"].identifier), uv, (16, 16), True
        )
        ours = value(shot.closures(name)[0]["color"])
        if not np.allclose(ours, baked[8, 4, :3], rtol=0.02, atol=2e-3):
            wrong.append((name, ours, baked[8, 4, :3]))
    assert not wrong, wrong


class Owner:
    """A stand-in for snapshot.Placed."""

    def __init__(self, source, material):
        self.name, self.source, self.materials, self.matrix = (
            source.name,
            source,
            [material],
            source.matrix_world,
        )

    def make_mesh(self, split):
        return self.source.data.copy(), np.array([[0, 1, 2], [0, 2, 3]])


run(globals())
