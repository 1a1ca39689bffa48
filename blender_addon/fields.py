# SPDX-License-Identifier: GPL-3.0-or-later
"""The one table of settings (no bpy).

It drives property creation (SCENE, OBJECT, COLLECTION, WORLD), the "settings" object of a snapshot
or layout request, and the ajar_settings / ajar_layout_settings structs (ENGINE, LAYOUT).
"""

from dataclasses import dataclass
from math import pi


@dataclass(frozen=True)
class Field:
    """One setting. kind is 'int', 'float', 'bool', 'enum' or 'string'; unit is for display."""

    name: str
    kind: str
    default: object
    minimum: float | None = None
    maximum: float | None = None
    unit: str = ""
    description: str = ""
    label: str = ""
    items: tuple = ()  # enum: (identifier, label, description)


# Fields of ajar_settings, in the order of the struct.
ENGINE_FIELDS = (
    Field(
        "bounces", "int", 6, 0, 64, "", "Diffuse bounces of every light; 0 bakes direct light only", "Bounces"
    ),
    Field(
        "noise_target",
        "float",
        0.12,
        0.0,
        1.0,
        "",
        "Relative standard error that 95% of the texels keep; 0 uses the sample count",
        "Noise target",
    ),
    Field(
        "time_limit",
        "float",
        0.0,
        0.0,
        1.0e6,
        "s",
        "Time limit of the whole bake; 0 means none",
        "Time limit",
    ),
    Field(
        "samples",
        "int",
        1024,
        1,
        1 << 20,
        "rays",
        "Final gather rays per texel: the cap of the noise target",
        "Samples",
    ),
    Field(
        "bounce_samples",
        "int",
        64,
        1,
        1 << 16,
        "rays",
        "Rays per texel and intermediate bounce",
        "Bounce samples",
    ),
    Field(
        "direct_samples",
        "int",
        64,
        1,
        1 << 16,
        "rays",
        "Shadow rays per texel in the final pass",
        "Direct samples",
    ),
    Field(
        "positions_per_texel",
        "int",
        4,
        1,
        16,
        "",
        "Places inside each texel that rays start from",
        "Positions per texel",
    ),
    Field("seed", "int", 0, 0, 2147483647, "", "Seed of the random numbers", "Seed"),
    Field("threads", "int", 0, 0, 1024, "", "Worker threads; 0 uses all processors", "Threads"),
    Field(
        "stitch_seams", "bool", True, description="Match texels across lightmap seams", label="Stitch seams"
    ),
    Field(
        "keep_sh", "bool", False, description="Keep spherical harmonics layers as EXR", label="Keep SH layers"
    ),
    Field(
        "keep_bounces", "bool", False, description="Keep every bounce apart (for tests)", label="Keep bounces"
    ),
    Field(
        "combinations",
        "enum",
        "AUTO",
        description="Which products of light sets, doors and toggles are baked beside the single ones",
        label="Combinations",
        items=(
            ("NONE", "None", "No combinations"),
            ("AUTO", "Auto", "Combinations that matter"),
            ("ALL", "All", "Every combination"),
        ),
    ),
    Field(
        "term_threshold",
        "float",
        0.01,
        0.0,
        1.0,
        "",
        "A texel keeps the light of an element where it is lit by it directly, or brighter than this "
        "share of its mean indirect light; 0 keeps all",
        "Keep threshold",
    ),
    Field(
        "door_rays",
        "float",
        0.25,
        0.0,
        1.0,
        "",
        "Final rays that aim at each door in sight, as a share of those over the hemisphere",
        "Door rays",
    ),
    Field(
        "check_points",
        "int",
        256,
        0,
        1048576,
        "texels",
        "Random texels at which brute force checks the finished bake; 0: no check",
        "Self-check",
    ),
    Field(
        "light_patches",
        "enum",
        "NONE",
        description="Also store a texture per light and per shadow of an object, for engines that blend plain "
        "textures: shadows of two objects that overlap are taken twice there",
        label="Light patches",
        items=(
            ("NONE", "None", "No light patches"),
            ("MONO", "Mono", "Luminance of each light set, and one colour for it"),
            ("RGB", "RGB", "Colour of each light set at every texel, at three times the size"),
        ),
    ),
    Field(
        "memory_limit",
        "float",
        0.0,
        0.0,
        1000000.0,
        "GB",
        "Memory that the light of sets, doors and toggles may take; 0: what is free. A bake that needs more ends "
        "with an error before the machine swaps",
        "Memory limit",
    ),
    Field(
        "overlap_pictures",
        "bool",
        False,
        description="Also store pictures of how many light sets, doors and toggles meet at a texel, and of the bytes "
        "that this takes",
        label="Overlap pictures",
    ),
)

# Fields of ajar_layout_settings, in the order of the struct.
LAYOUT_FIELDS = (
    Field(
        "texels_per_meter",
        "float",
        8.0,
        0.01,
        4096.0,
        "1/m",
        "Lightmap texels per metre of surface",
        "Texels per metre",
    ),
    Field("atlas_size", "int", 1024, 16, 16384, "texels", "Largest edge of a lightmap page", "Page size"),
    Field("padding", "int", 2, 0, 64, "texels", "Texels kept free between charts", "Padding"),
    Field(
        "chart_angle",
        "float",
        0.7853981633974483,
        0.0,
        pi / 2,
        "rad",
        "Angle a face normal may leave its chart's axis",
        "Chart angle",
    ),
)

PRESET_ITEMS = (
    ("DRAFT", "Draft", "20% noise: is the light where it should be"),
    ("PREVIEW", "Preview", "5% noise: for daily work"),
    ("PRODUCTION", "Production", "1.5% noise: to ship"),
    ("REFERENCE", "Reference", "0.5% noise: to judge the others by"),
)


_BY_NAME = {f.name: f for f in ENGINE_FIELDS + LAYOUT_FIELDS}

# Scene.ajar. noise_target 0 takes the preset's; light_sets is a collection made elsewhere.
SCENE_FIELDS = (
    _BY_NAME["texels_per_meter"],
    _BY_NAME["atlas_size"],
    _BY_NAME["padding"],
    _BY_NAME["chart_angle"],
    Field("preset", "enum", "PREVIEW", description="Quality of the bake", label="Preset", items=PRESET_ITEMS),
    _BY_NAME["bounces"],
    Field(
        "noise_target",
        "float",
        0.0,
        0.0,
        1.0,
        "",
        "Relative standard error that 95% of the texels keep; 0 takes the preset's",
        "Noise target",
    ),
    _BY_NAME["time_limit"],
    _BY_NAME["seed"],
    _BY_NAME["threads"],
    Field(
        "output_dir",
        "string",
        "//lightmaps/",
        description="Folder of the baked package",
        label="Output folder",
    ),
    _BY_NAME["combinations"],
    _BY_NAME["term_threshold"],
    _BY_NAME["light_patches"],
    _BY_NAME["memory_limit"],
)

OBJECT_FIELDS = (
    Field(
        "light_role",
        "enum",
        "PRIMARY",
        description="What is baked of this light",
        label="Role",
        items=(
            ("PRIMARY", "Primary", "Only bounced light is baked; the game adds direct light"),
            ("STATIC", "Static", "Direct and bounced light are baked"),
            ("OFF", "Off", "Not baked"),
        ),
    ),
    Field("light_set", "string", "", description="Light set of this light; empty: none", label="Light set"),
    Field(
        "surface",
        "enum",
        "AUTO",
        description="How this object takes part in the bake",
        label="Surface",
        items=(
            ("AUTO", "Auto", "Lightmap if the mesh can carry one"),
            ("LIGHTMAP", "Lightmap", "Receives a lightmap"),
            ("LIGHT_GRID", "Light grid", "Lit by probes; blocks and bounces light"),
            ("OCCLUDER", "Occluder", "Blocks and bounces light, stores nothing"),
            ("IGNORE", "Ignore", "Not part of the bake"),
        ),
    ),
    Field(
        "texel_scale", "float", 1.0, 0.001, 1000.0, "", "Factor of the scene's texel density", "Texel scale"
    ),
    Field(
        "bake_side",
        "enum",
        "FRONT",
        description="Side of its surfaces whose light the lightmap holds",
        label="Bake side",
        items=(
            ("FRONT", "Front", "The side that the normals point to"),
            ("BACK", "Back", "The other side, as if the normals were flipped"),
        ),
    ),
    Field(
        "movable",
        "enum",
        "FIXED",
        description="What changes at run time",
        label="Movable",
        items=(
            ("FIXED", "Fixed", "Nothing"),
            ("DOOR", "Door", "Opens and closes"),
            ("TOGGLE", "Toggle", "Can be hidden"),
        ),
    ),
    Field(
        "bounce_when_closed",
        "bool",
        True,
        description="The closed door reflects light",
        label="Bounce when closed",
    ),
    Field("openness", "float", 0.0, 0.0, 1.0, "", "0 closed, 1 open", "Openness"),
    Field("presence", "float", 1.0, 0.0, 1.0, "", "0 hidden, 1 there", "Presence"),
    Field(
        "combine",
        "bool",
        True,
        description="Bake its combinations with other elements too, where they overlap",
        label="Combine",
    ),
)

_OF_COLLECTION = ("light_set", "movable", "bounce_when_closed", "openness", "presence", "combine")

# Collection.ajar: members inherit these, and movable makes the whole collection one element.
COLLECTION_FIELDS = tuple(f for f in OBJECT_FIELDS if f.name in _OF_COLLECTION)

WORLD_FIELDS = (
    Field(
        "sky_role",
        "enum",
        "BAKED",
        description="Whether the sky lights the bake",
        label="Sky",
        items=(("BAKED", "Baked", "Direct and bounced light are baked"), ("OFF", "Off", "Not baked")),
    ),
)
