# SPDX-License-Identifier: GPL-3.0-or-later
"""ctypes mirror of native/include/ajar/ajar.h; tests compare it with the header."""

import ctypes as c

ABI_VERSION = 1
NONE = 0xFFFFFFFF
MAX_CLOSURES = 8
MAX_TERM_ELEMENTS = 8

OK, CANCELLED, RUNNING = 0, 1, 2
ERROR_ARGUMENT, ERROR_STRUCT_SIZE, ERROR_HANDLE, ERROR_STATE = -1, -2, -3, -4
ERROR_INPUT, ERROR_MEMORY, ERROR_IO, ERROR_BUFFER = -5, -6, -7, -8
ERROR_CPU, ERROR_INTERNAL = -9, -10

# Words of snapshot.json -> numbers of the ABI.
TEXEL = {"u8": 0, "f32": 1}
COLOR = {"linear": 0, "srgb": 1}
EXTEND = {"repeat": 0, "edge": 1, "clip": 2}
CHANNEL = {"rgb": 0, "r": 1, "g": 2, "b": 3, "a": 4}
CLOSURE = {"diffuse": 0, "principled": 1, "emission": 2, "transparent": 3}
SURFACE = {"lightmap": 0, "occluder": 1}
SIDE = {"front": 0, "back": 1}
VISIBLE = {"gather": 1, "shadow": 2}
LIGHT = {"point": 0, "spot": 1, "sun": 2, "rectangle": 3, "ellipse": 4}
ELEMENT = {"light_set": 0, "door": 1, "toggle": 2}
COMBINATIONS = {"NONE": 0, "AUTO": 1, "ALL": 2}
LIGHT_PATCHES = {"NONE": 0, "MONO": 1, "RGB": 2}
CHOICES = {"combinations": COMBINATIONS, "light_patches": LIGHT_PATCHES}
ROLE = {"primary": 0, "static": 1}
CHOICE = {"area": 0, "texel": 1}
SKY = {"none": 0, "constant": 1, "equirect": 2}

Handle = c.c_void_p
Result = c.c_int32
u32, u64, f32, f64 = c.c_uint32, c.c_uint64, c.c_float, c.c_double
floats, uints, bytes_ = c.POINTER(f32), c.POINTER(u32), c.POINTER(c.c_uint8)


class TextureDesc(c.Structure):
    _fields_ = [
        ("struct_size", u32),
        ("name", c.c_char_p),
        ("width", u32),
        ("height", u32),
        ("texel", u32),
        ("color", u32),
        ("extend", u32),
        ("nearest", u32),
        ("texels", c.c_void_p),
        ("texel_bytes", u64),
    ]


class Input(c.Structure):
    _fields_ = [
        ("value", f32 * 3),
        ("texture", u32),
        ("uv_layer", u32),
        ("color_layer", u32),
        ("channel", u32),
        ("invert", u32),
        ("uv_transform", f32 * 6),
    ]


class Closure(c.Structure):
    _fields_ = [
        ("type", u32),
        ("weight_a", Input),
        ("weight_b", Input),
        ("color", Input),
        ("strength", Input),
        ("metallic", Input),
        ("roughness", Input),
        ("specular", f32),
    ]


class MaterialDesc(c.Structure):
    _fields_ = [
        ("struct_size", u32),
        ("name", c.c_char_p),
        ("closure_count", u32),
        ("closures", c.POINTER(Closure)),
        ("one_sided", u32),
    ]


class MeshDesc(c.Structure):
    _fields_ = [
        ("struct_size", u32),
        ("name", c.c_char_p),
        ("vertex_count", u32),
        ("triangle_count", u32),
        ("positions", floats),
        ("corner_vertex", uints),
        ("corner_normals", floats),
        ("triangle_slot", uints),
        ("uv_layer_count", u32),
        ("uv_layers", c.POINTER(floats)),
        ("color_layer_count", u32),
        ("color_layers", c.POINTER(floats)),
    ]


class ElementDesc(c.Structure):
    _fields_ = [
        ("struct_size", u32),
        ("name", c.c_char_p),
        ("kind", u32),
        ("weight", f32),
        ("combine", u32),
        ("bounce", u32),
    ]


class InstanceDesc(c.Structure):
    _fields_ = [
        ("struct_size", u32),
        ("name", c.c_char_p),
        ("mesh", u32),
        ("transform", f64 * 12),
        ("material_count", u32),
        ("materials", uints),
        ("surface", u32),
        ("visibility", u32),
        ("lightmap_layer", u32),
        ("page", u32),
        ("uv_scale", f32 * 2),
        ("uv_offset", f32 * 2),
        ("element", u32),
        ("open_pose", u32),
        ("light_set", u32),
        ("bake_side", u32),
    ]


class LightDesc(c.Structure):
    _fields_ = [
        ("struct_size", u32),
        ("name", c.c_char_p),
        ("type", u32),
        ("role", u32),
        ("transform", f64 * 12),
        ("color", f32 * 3),
        ("energy", f32),
        ("radius", f32),
        ("spot_angle", f32),
        ("spot_blend", f32),
        ("sun_angle", f32),
        ("size_x", f32),
        ("size_y", f32),
        ("spread", f32),
        ("casts_shadow", u32),
        ("light_set", u32),
    ]


class SkyDesc(c.Structure):
    _fields_ = [("struct_size", u32), ("type", u32), ("color", f32 * 3), ("texture", u32)]


class Settings(c.Structure):
    _fields_ = [
        ("struct_size", u32),
        ("bounces", u32),
        ("noise_target", f32),
        ("time_limit", f32),
        ("samples", u32),
        ("bounce_samples", u32),
        ("direct_samples", u32),
        ("positions_per_texel", u32),
        ("seed", u32),
        ("threads", u32),
        ("stitch_seams", u32),
        ("keep_sh", u32),
        ("keep_bounces", u32),
        ("combinations", u32),
        ("term_threshold", f32),
        ("door_rays", f32),
        ("check_points", u32),
        ("light_patches", u32),
        ("trial", u32),
        ("memory_limit", f32),
        ("overlap_pictures", u32),
    ]


class TermInfo(c.Structure):
    _fields_ = [
        ("struct_size", u32),
        ("element_count", u32),
        ("elements", u32 * MAX_TERM_ELEMENTS),
        ("is_signed", u32),
        ("texel_count", u64),
        ("relative_error", f32),
        ("discarded", f32),
    ]


class Progress(c.Structure):
    _fields_ = [
        ("struct_size", u32),
        ("stage", u32),
        ("fraction", f32),
        ("elapsed", f32),
        ("remaining", f32),
        ("result", Result),
        ("rays", u64),
    ]


class ReferenceSettings(c.Structure):
    _fields_ = [
        ("struct_size", u32),
        ("points", u32),
        ("bounces", u32),
        ("batches", u32),
        ("time_limit", f32),
        ("seed", u32),
        ("point_seed", u32),
        ("threads", u32),
        ("choice", u32),
        ("texel_mean", u32),
        ("normal", f32 * 3),
        ("weight_count", u32),
        ("weights", floats),
        ("door_bounces", u32),
    ]


class ReferencePoint(c.Structure):
    _fields_ = [
        ("page", u32),
        ("x", u32),
        ("y", u32),
        ("instance", u32),
        ("triangle", u32),
        ("u", f32),
        ("v", f32),
        ("irradiance", f32 * 3),
        ("standard_error", f32),
    ]


class LayoutSettings(c.Structure):
    _fields_ = [
        ("struct_size", u32),
        ("texels_per_meter", f32),
        ("atlas_size", u32),
        ("padding", u32),
        ("chart_angle", f32),
    ]


class LayoutMeshDesc(c.Structure):
    _fields_ = [
        ("struct_size", u32),
        ("name", c.c_char_p),
        ("vertex_count", u32),
        ("corner_count", u32),
        ("polygon_count", u32),
        ("positions", floats),
        ("corner_vertex", uints),
        ("polygon_start", uints),
        ("polygon_size", uints),
        ("corner_edge_sharp", bytes_),
        ("corner_uv", floats),
        ("user_count", u32),
        ("user_transforms", c.POINTER(f64)),
        ("user_texel_scale", floats),
    ]


# struct name in the header -> mirror; used by the tests as well.
STRUCTS = {
    "ajar_texture_desc": TextureDesc,
    "ajar_input": Input,
    "ajar_closure": Closure,
    "ajar_material_desc": MaterialDesc,
    "ajar_mesh_desc": MeshDesc,
    "ajar_element_desc": ElementDesc,
    "ajar_term_info": TermInfo,
    "ajar_instance_desc": InstanceDesc,
    "ajar_light_desc": LightDesc,
    "ajar_sky_desc": SkyDesc,
    "ajar_settings": Settings,
    "ajar_progress": Progress,
    "ajar_reference_settings": ReferenceSettings,
    "ajar_reference_point": ReferencePoint,
    "ajar_layout_settings": LayoutSettings,
    "ajar_layout_mesh_desc": LayoutMeshDesc,
}

P = c.POINTER
_TEXT = [c.c_char_p, u64, c.c_char_p, u64]

# function -> (restype, argtypes)
FUNCTIONS = {
    "ajar_abi_version": (u32, []),
    "ajar_version": (c.c_char_p, []),
    "ajar_result_text": (c.c_char_p, [Result]),
    "ajar_error_message": (c.c_char_p, []),
    "ajar_error_culprit": (c.c_char_p, []),
    "ajar_texture_desc_init": (None, [P(TextureDesc)]),
    "ajar_input_init": (None, [P(Input)]),
    "ajar_closure_init": (None, [P(Closure)]),
    "ajar_material_desc_init": (None, [P(MaterialDesc)]),
    "ajar_mesh_desc_init": (None, [P(MeshDesc)]),
    "ajar_element_desc_init": (None, [P(ElementDesc)]),
    "ajar_instance_desc_init": (None, [P(InstanceDesc)]),
    "ajar_light_desc_init": (None, [P(LightDesc)]),
    "ajar_sky_desc_init": (None, [P(SkyDesc)]),
    "ajar_scene_create": (Result, [c.c_char_p, P(Handle)]),
    "ajar_scene_release": (Result, [P(Handle)]),
    "ajar_scene_add_texture": (Result, [Handle, P(TextureDesc), uints]),
    "ajar_scene_add_material": (Result, [Handle, P(MaterialDesc), uints]),
    "ajar_scene_add_mesh": (Result, [Handle, P(MeshDesc), uints]),
    "ajar_scene_add_element": (Result, [Handle, P(ElementDesc), uints]),
    "ajar_scene_add_instance": (Result, [Handle, P(InstanceDesc), uints]),
    "ajar_scene_add_light": (Result, [Handle, P(LightDesc), uints]),
    "ajar_scene_add_page": (Result, [Handle, u32, u32, uints]),
    "ajar_scene_set_sky": (Result, [Handle, P(SkyDesc)]),
    "ajar_scene_commit": (Result, [Handle]),
    "ajar_scene_warning_count": (Result, [Handle, uints]),
    "ajar_scene_warning": (Result, [Handle, u32] + _TEXT),
    "ajar_settings_init": (None, [P(Settings)]),
    "ajar_progress_init": (None, [P(Progress)]),
    "ajar_stage_name": (c.c_char_p, [u32]),
    "ajar_job_start": (Result, [Handle, P(Settings), P(Handle)]),
    "ajar_job_poll": (Result, [Handle, P(Progress)]),
    "ajar_job_cancel": (Result, [Handle]),
    "ajar_job_wait": (Result, [Handle, f64]),
    "ajar_job_error": (Result, [Handle] + _TEXT),
    "ajar_job_release": (Result, [P(Handle)]),
    "ajar_job_layer_size": (Result, [Handle, u32, u32, uints, uints, uints]),
    "ajar_job_read_layer": (Result, [Handle, u32, u32, floats, u64]),
    "ajar_term_info_init": (None, [P(TermInfo)]),
    "ajar_job_term_count": (Result, [Handle, uints]),
    "ajar_job_term": (Result, [Handle, u32, P(TermInfo)]),
    "ajar_job_read_term": (Result, [Handle, u32, u32, floats, u64]),
    "ajar_job_report": (Result, [Handle, c.c_char_p, P(u64)]),
    "ajar_job_write_package": (Result, [Handle, c.c_char_p, c.c_char_p]),
    "ajar_reference_settings_init": (None, [P(ReferenceSettings)]),
    "ajar_reference_start": (Result, [Handle, P(ReferenceSettings), P(Handle)]),
    "ajar_reference_poll": (Result, [Handle, P(Progress)]),
    "ajar_reference_cancel": (Result, [Handle]),
    "ajar_reference_wait": (Result, [Handle, f64]),
    "ajar_reference_error": (Result, [Handle] + _TEXT),
    "ajar_reference_release": (Result, [P(Handle)]),
    "ajar_reference_read": (Result, [Handle, P(ReferencePoint), u64, uints]),
    "ajar_layout_settings_init": (None, [P(LayoutSettings)]),
    "ajar_layout_mesh_desc_init": (None, [P(LayoutMeshDesc)]),
    "ajar_layout_create": (Result, [P(LayoutSettings), P(Handle)]),
    "ajar_layout_release": (Result, [P(Handle)]),
    "ajar_layout_add_mesh": (Result, [Handle, P(LayoutMeshDesc), uints]),
    "ajar_layout_run": (Result, [Handle]),
    "ajar_layout_page_count": (Result, [Handle, uints]),
    "ajar_layout_page_size": (Result, [Handle, u32, uints, uints]),
    "ajar_layout_mesh_uv": (Result, [Handle, u32, floats, u64]),
    "ajar_layout_user": (Result, [Handle, u32, u32, uints, floats, floats, floats]),
    "ajar_layout_warning_count": (Result, [Handle, uints]),
    "ajar_layout_warning": (Result, [Handle, u32] + _TEXT),
}
