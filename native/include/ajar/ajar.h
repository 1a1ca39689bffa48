/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * ajar.h - the whole bake ABI of Ajar, valid C99 and C++.
 *
 * Conventions
 *   Units      metres, Z up, scene-linear Rec.709, W, W/m^2, W/(m^2 sr), radians, seconds.
 *   Ownership  every input array and string is copied before the call returns; every output goes
 *              into a buffer of the caller. Nothing else crosses the boundary.
 *   Errors     each fallible function returns an ajar_result (0 = success). The message and the
 *              culprit (name of the object, image or file at fault) of the last failure on this
 *              thread are valid until the next call on it. A job keeps its own.
 *   Structs    begin with struct_size; fill them with the matching *_init function first. A size
 *              this library does not know is refused with AJAR_ERROR_STRUCT_SIZE.
 *   Handles    are checked: NULL, stale and foreign values give AJAR_ERROR_HANDLE.
 *   Threads    one scene or layout is used from one thread at a time; jobs are polled from any.
 *              No function calls back into the host, prints, throws or exits.
 */
#ifndef AJAR_AJAR_H
#define AJAR_AJAR_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#define AJAR_API __declspec(dllexport)
#else
#define AJAR_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define AJAR_ABI_VERSION 1u
#define AJAR_NONE 0xffffffffu /* "no texture", "no layer", "no page" */

typedef int32_t ajar_result;
enum {
    AJAR_OK = 0,
    AJAR_CANCELLED = 1,          /* a job ended because it was asked to */
    AJAR_RUNNING = 2,            /* a wait ran out of time, or a result is asked for too early */
    AJAR_ERROR_ARGUMENT = -1,    /* null pointer, count or enum out of range */
    AJAR_ERROR_STRUCT_SIZE = -2, /* struct_size is not one this library knows */
    AJAR_ERROR_HANDLE = -3,      /* null, stale or foreign handle */
    AJAR_ERROR_STATE = -4,       /* call out of order, e.g. adding to a committed scene */
    AJAR_ERROR_INPUT = -5,       /* scene data that cannot be baked; see message and culprit */
    AJAR_ERROR_MEMORY = -6,
    AJAR_ERROR_IO = -7,
    AJAR_ERROR_BUFFER = -8, /* caller's buffer is too small; the needed size is written back */
    AJAR_ERROR_CPU = -9,    /* this processor lacks instructions the library was built for */
    AJAR_ERROR_INTERNAL = -10
};

typedef struct ajar_scene_impl* ajar_scene;
typedef struct ajar_job_impl* ajar_job;
typedef struct ajar_layout_impl* ajar_layout;
typedef struct ajar_reference_impl* ajar_reference;

/* ---- library ------------------------------------------------------------------------------ */

/* AJAR_ABI_VERSION of the loaded library; check it before anything else. */
AJAR_API uint32_t ajar_abi_version(void);
/* Semantic version, e.g. "0.1.0". Static storage. */
AJAR_API const char* ajar_version(void);
/* Short English text for a result code; never NULL. Static storage. */
AJAR_API const char* ajar_result_text(ajar_result code);
/* Message and culprit of the last failure on this thread; "" if none. */
AJAR_API const char* ajar_error_message(void);
AJAR_API const char* ajar_error_culprit(void);

/* ---- scene -------------------------------------------------------------------------------- */

enum { AJAR_TEXEL_U8 = 0, AJAR_TEXEL_F32 = 1 };
enum { AJAR_COLOR_LINEAR = 0, AJAR_COLOR_SRGB = 1 };
enum { AJAR_EXTEND_REPEAT = 0, AJAR_EXTEND_EDGE = 1, AJAR_EXTEND_CLIP = 2 };

/* Image: width*height*4 texels RGBA, first row at v = 0 (bottom), straight alpha. */
typedef struct ajar_texture_desc {
    uint32_t struct_size;
    const char* name;
    uint32_t width, height;
    uint32_t texel;   /* AJAR_TEXEL_* */
    uint32_t color;   /* AJAR_COLOR_*; alpha is always linear */
    uint32_t extend;  /* AJAR_EXTEND_* */
    uint32_t nearest; /* 1: no interpolation */
    const void* texels;
    uint64_t texel_bytes; /* size of texels, checked */
} ajar_texture_desc;

enum { AJAR_CHANNEL_RGB = 0, AJAR_CHANNEL_R = 1, AJAR_CHANNEL_G = 2, AJAR_CHANNEL_B = 3, AJAR_CHANNEL_A = 4 };

/* One material input: value * texture(uv_transform * uv[uv_layer]) * vertex colour[color_layer],
 * reduced to channel, then 1 - x if invert. Scalars read value[0]. */
typedef struct ajar_input {
    float value[3];
    uint32_t texture;     /* texture id or AJAR_NONE */
    uint32_t uv_layer;    /* index into the mesh's UV layers */
    uint32_t color_layer; /* index into the mesh's colour layers or AJAR_NONE */
    uint32_t channel;     /* AJAR_CHANNEL_* of the texture or colour */
    uint32_t invert;
    float uv_transform[6]; /* row-major 2x3 affine */
} ajar_input;

enum { AJAR_CLOSURE_DIFFUSE = 0, AJAR_CLOSURE_PRINCIPLED = 1, AJAR_CLOSURE_EMISSION = 2, AJAR_CLOSURE_TRANSPARENT = 3 };

/* One term of a material: weight_a * weight_b * closure. */
typedef struct ajar_closure {
    uint32_t type;       /* AJAR_CLOSURE_* */
    ajar_input weight_a; /* scalar in [0,1] */
    ajar_input weight_b; /* scalar in [0,1] */
    ajar_input color;    /* reflectance, transmittance, or radiance W/(m^2 sr) of emission */
    ajar_input strength; /* scalar factor of color, used by emission */
    ajar_input metallic;
    ajar_input roughness;
    float specular; /* Blender's 0..1; F0 = 0.08 * specular */
} ajar_closure;

/* Material: the sum of its closures. Reflecting closures become Lambertian with their total
 * hemispherical reflectance. */
typedef struct ajar_material_desc {
    uint32_t struct_size;
    const char* name;
    uint32_t closure_count; /* 0..AJAR_MAX_CLOSURES */
    const ajar_closure* closures;
    uint32_t one_sided; /* 1: back faces neither reflect nor emit */
} ajar_material_desc;
#define AJAR_MAX_CLOSURES 8u

/* Triangle mesh in its local space. Corner arrays hold 3*triangle_count entries. */
typedef struct ajar_mesh_desc {
    uint32_t struct_size;
    const char* name;
    uint32_t vertex_count;
    uint32_t triangle_count;
    const float* positions;        /* [vertex_count][3] */
    const uint32_t* corner_vertex; /* [3*triangle_count] */
    const float* corner_normals;   /* [3*triangle_count][3] unit shading normals, or NULL: flat */
    const uint32_t* triangle_slot; /* [triangle_count] material slot, or NULL: all 0 */
    uint32_t uv_layer_count;
    const float* const* uv_layers; /* [uv_layer_count] of [3*triangle_count][2] */
    uint32_t color_layer_count;
    const float* const* color_layers; /* [color_layer_count] of [3*triangle_count][4], linear */
} ajar_mesh_desc;

enum { AJAR_ELEMENT_LIGHT_SET = 0, AJAR_ELEMENT_DOOR = 1, AJAR_ELEMENT_TOGGLE = 2 };

/* Something that changes at run time. Its weight: strength of a light set, openness of a door,
 * presence of a toggle. Lights and instances name their elements, so elements are added first. */
typedef struct ajar_element_desc {
    uint32_t struct_size;
    const char* name;
    uint32_t kind;    /* AJAR_ELEMENT_* */
    float weight;     /* at the start: light set in [0, inf), door and toggle in [0, 1] */
    uint32_t combine; /* 0: takes part in no combination with other elements */
    uint32_t bounce;  /* door: 0 makes the closed leaf black, 1 lets it reflect light */
} ajar_element_desc;

enum { AJAR_SURFACE_LIGHTMAP = 0, AJAR_SURFACE_OCCLUDER = 1 };
enum { AJAR_VISIBLE_GATHER = 1, AJAR_VISIBLE_SHADOW = 2 };
enum { AJAR_SIDE_FRONT = 0, AJAR_SIDE_BACK = 1 };

/* A placed mesh. Lightmapped instances name their page; page UV = uv * uv_scale + uv_offset. */
typedef struct ajar_instance_desc {
    uint32_t struct_size;
    const char* name;
    uint32_t mesh;
    double transform[12];      /* row-major 3x4, local to world */
    uint32_t material_count;   /* slots */
    const uint32_t* materials; /* [material_count] material ids */
    uint32_t surface;          /* AJAR_SURFACE_*; an occluder blocks and bounces, stores nothing */
    uint32_t visibility;       /* AJAR_VISIBLE_* bits */
    uint32_t lightmap_layer;   /* UV layer with lightmap UVs in [0,1], or AJAR_NONE */
    uint32_t page;
    float uv_scale[2];
    float uv_offset[2];
    uint32_t element;   /* door or toggle this is a part of, or AJAR_NONE */
    uint32_t open_pose; /* 1: part of a door that is there while it is open; 0: the closed leaf */
    uint32_t light_set; /* light set that its emission belongs to, or AJAR_NONE */
    uint32_t bake_side; /* AJAR_SIDE_*: whose light a lightmap holds, of the side that the normals point to or of the
                         * other; tangent frames turn with it. One-sided materials have a front only. */
} ajar_instance_desc;

enum {
    AJAR_LIGHT_POINT = 0,
    AJAR_LIGHT_SPOT = 1,
    AJAR_LIGHT_SUN = 2,
    AJAR_LIGHT_AREA_RECTANGLE = 3,
    AJAR_LIGHT_AREA_ELLIPSE = 4
};
enum { AJAR_ROLE_PRIMARY = 0, AJAR_ROLE_STATIC = 1 };

/* A lamp in Blender's units; it shines along its local -Z. */
typedef struct ajar_light_desc {
    uint32_t struct_size;
    const char* name;
    uint32_t type;        /* AJAR_LIGHT_* */
    uint32_t role;        /* AJAR_ROLE_* */
    double transform[12]; /* row-major 3x4, light to world */
    float color[3];
    float energy;         /* W for point, spot, area; W/m^2 for sun */
    float radius;         /* m: point, spot */
    float spot_angle;     /* full cone angle, radians */
    float spot_blend;     /* 0..1 */
    float sun_angle;      /* full angular diameter, radians */
    float size_x, size_y; /* m: area, full extents in local x and y, before the transform's scale */
    float spread;         /* area: full emission angle, radians, pi = Lambertian */
    uint32_t casts_shadow;
    uint32_t light_set; /* light set it belongs to, or AJAR_NONE */
} ajar_light_desc;

enum { AJAR_SKY_NONE = 0, AJAR_SKY_CONSTANT = 1, AJAR_SKY_EQUIRECT = 2 };

/* Sky radiance: constant, or color * equirectangular texture in Blender's mapping: direction
 * (x, y, z) reads u = -atan2(y, x) / (2 pi) + 0.5, v = 0.5 + asin(z) / pi, v = 1 at the zenith. */
typedef struct ajar_sky_desc {
    uint32_t struct_size;
    uint32_t type; /* AJAR_SKY_* */
    float color[3];
    uint32_t texture;
} ajar_sky_desc;

AJAR_API void ajar_texture_desc_init(ajar_texture_desc* desc);
AJAR_API void ajar_input_init(ajar_input* input);
AJAR_API void ajar_closure_init(ajar_closure* closure);
AJAR_API void ajar_material_desc_init(ajar_material_desc* desc);
AJAR_API void ajar_mesh_desc_init(ajar_mesh_desc* desc);
AJAR_API void ajar_element_desc_init(ajar_element_desc* desc);
AJAR_API void ajar_instance_desc_init(ajar_instance_desc* desc);
AJAR_API void ajar_light_desc_init(ajar_light_desc* desc);
AJAR_API void ajar_sky_desc_init(ajar_sky_desc* desc);

/* An empty scene; name appears in messages and the report. */
AJAR_API ajar_result ajar_scene_create(const char* name, ajar_scene* out_scene);
/* Frees the scene and sets *scene to NULL. A job that uses it keeps its own reference. */
AJAR_API ajar_result ajar_scene_release(ajar_scene* scene);
/* Each add_* copies its input and writes the new id, counted from 0 per kind. Data that is wrong
 * but harmless to the rest (NaN vertex, degenerate triangle) is dropped and becomes a warning. */
AJAR_API ajar_result ajar_scene_add_texture(ajar_scene scene, const ajar_texture_desc* desc, uint32_t* out_id);
AJAR_API ajar_result ajar_scene_add_material(ajar_scene scene, const ajar_material_desc* desc, uint32_t* out_id);
AJAR_API ajar_result ajar_scene_add_mesh(ajar_scene scene, const ajar_mesh_desc* desc, uint32_t* out_id);
AJAR_API ajar_result ajar_scene_add_element(ajar_scene scene, const ajar_element_desc* desc, uint32_t* out_id);
AJAR_API ajar_result ajar_scene_add_instance(ajar_scene scene, const ajar_instance_desc* desc, uint32_t* out_id);
AJAR_API ajar_result ajar_scene_add_light(ajar_scene scene, const ajar_light_desc* desc, uint32_t* out_id);
AJAR_API ajar_result ajar_scene_add_page(ajar_scene scene, uint32_t width, uint32_t height, uint32_t* out_id);
AJAR_API ajar_result ajar_scene_set_sky(ajar_scene scene, const ajar_sky_desc* desc);
/* Ends building: cross-checks ids and freezes the scene. */
AJAR_API ajar_result ajar_scene_commit(ajar_scene scene);
/* Warnings so far. Text and culprit are copied, NUL-terminated, cut to the sizes given. */
AJAR_API ajar_result ajar_scene_warning_count(ajar_scene scene, uint32_t* out_count);
AJAR_API ajar_result ajar_scene_warning(ajar_scene scene, uint32_t index, char* text, uint64_t text_size, char* culprit,
                                        uint64_t culprit_size);

/* ---- bake --------------------------------------------------------------------------------- */

/* Which products of elements are baked beside the single ones. */
enum { AJAR_COMBINATIONS_NONE = 0, AJAR_COMBINATIONS_AUTO = 1, AJAR_COMBINATIONS_ALL = 2 };
#define AJAR_MAX_TERM_ELEMENTS 8u

/* Whether the package also holds plain textures to blend, after "Semi-Dynamic Light Maps": a map per
 * light and per object that shadows it, cut into patches in RGBA16F atlases (patches.json). MONO: the
 * maps of light sets are luminance with one colour per set, as in the paper; RGB: they keep colour. */
enum { AJAR_LIGHT_PATCHES_NONE = 0, AJAR_LIGHT_PATCHES_MONO = 1, AJAR_LIGHT_PATCHES_RGB = 2 };

typedef struct ajar_settings {
    uint32_t struct_size;
    uint32_t bounces;             /* diffuse bounces of every light; 0 = direct only */
    float noise_target;           /* relative standard error that 95 % of texels keep; 0 = use samples */
    float time_limit;             /* s, whole bake; 0 = none */
    uint32_t samples;             /* final gather rays per texel when noise_target is 0, else the cap; power of two */
    uint32_t bounce_samples;      /* rays per texel and intermediate bounce; power of two */
    uint32_t direct_samples;      /* shadow rays per texel in the final pass when noise_target is 0, else the cap */
    uint32_t positions_per_texel; /* 1..16 */
    uint32_t seed;
    uint32_t threads;       /* 0 = all */
    uint32_t stitch_seams;  /* 1: least-squares seam stitching */
    uint32_t keep_sh;       /* 1: keep 9-coefficient SH layers */
    uint32_t keep_bounces;  /* 1: keep the irradiance of every bounce apart (tests) */
    uint32_t combinations;  /* AJAR_COMBINATIONS_* */
    float term_threshold;   /* a texel keeps a term if lit by it directly or brighter than this share
                               of the term's mean indirect light there; 0 keeps all */
    float door_rays;        /* final rays that aim at each door in sight, as a share of those over the
                               hemisphere; 0..1, 0 = none */
    uint32_t check_points;  /* random texels at which brute force checks the finished bake; 0 = none, the default */
    uint32_t light_patches; /* AJAR_LIGHT_PATCHES_* */
    uint32_t trial;         /* 1: no bake and no light, but a pilot of seconds; its report says under "texels" and
                               "predicted_seconds" how much work the other settings are, on this machine */
    float memory_limit;     /* GB that the light of sets, doors and toggles may take; 0 = what is free. A bake that
                               needs more ends with AJAR_ERROR_MEMORY before the machine swaps */
    /* 1: the package has pictures of how many terms, and how many bytes of terms.bin, each texel takes. */
    uint32_t overlap_pictures;
} ajar_settings;
AJAR_API void ajar_settings_init(ajar_settings* settings);

enum {
    AJAR_STAGE_IDLE = 0,
    AJAR_STAGE_RECEIVERS,
    AJAR_STAGE_ACCEL,
    AJAR_STAGE_DIRECT,
    AJAR_STAGE_BOUNCES,
    AJAR_STAGE_PILOT,
    AJAR_STAGE_GATHER,
    AJAR_STAGE_POST,
    AJAR_STAGE_ENCODE,
    AJAR_STAGE_DONE,
    AJAR_STAGE_COUNT
};

typedef struct ajar_progress {
    uint32_t struct_size;
    uint32_t stage;     /* AJAR_STAGE_* */
    float fraction;     /* of the whole bake, 0..1 */
    float elapsed;      /* s */
    float remaining;    /* s, estimated; negative while unknown */
    ajar_result result; /* AJAR_RUNNING until the job ends */
    uint64_t rays;      /* traced so far */
} ajar_progress;
AJAR_API void ajar_progress_init(ajar_progress* progress);
/* Name of a stage for display, e.g. "final gather"; never NULL. Static storage. */
AJAR_API const char* ajar_stage_name(uint32_t stage);

/* Starts baking a committed scene on the library's own threads. */
AJAR_API ajar_result ajar_job_start(ajar_scene scene, const ajar_settings* settings, ajar_job* out_job);
AJAR_API ajar_result ajar_job_poll(ajar_job job, ajar_progress* out_progress);
/* Asks the job to stop; it ends with AJAR_CANCELLED within a second. */
AJAR_API ajar_result ajar_job_cancel(ajar_job job);
/* Waits up to timeout seconds (negative: forever) and returns the job's result, or AJAR_RUNNING. */
AJAR_API ajar_result ajar_job_wait(ajar_job job, double timeout);
/* The job's own failure message and culprit, cut to the sizes given. */
AJAR_API ajar_result ajar_job_error(ajar_job job, char* text, uint64_t text_size, char* culprit, uint64_t culprit_size);
/* Cancels if needed, waits, frees, sets *job to NULL. */
AJAR_API ajar_result ajar_job_release(ajar_job* job);

enum {
    AJAR_LAYER_IRRADIANCE = 0, /* 3 channels, W/m^2 along the shading normal */
    AJAR_LAYER_STDERR = 1,     /* 1 channel, standard error of its luminance, W/m^2 */
    AJAR_LAYER_SAMPLES = 2,    /* 1 channel, gather rays */
    AJAR_LAYER_VALIDITY = 3,   /* 1 channel, 1 valid, 0.75 outside its chart (only bilinear lookups touch it),
                                  0.5 covered but invalid (filled), 0 not covered */
    AJAR_LAYER_SH = 4,         /* 27 channels (coefficient-major RGB), radiance, tangent frame; keep_sh */
    AJAR_LAYER_ALBEDO = 5,     /* 3 channels, total hemispherical reflectance */
    AJAR_LAYER_AHD = 6,        /* 2 channels of raw 32 bit words: R11G11B10F over the package's scale, RGBA8 */
    AJAR_LAYER_BOUNCE = 16     /* + b: 3 channels, irradiance of bounce b; keep_bounces */
};
/* Size of one page's layer: rows bottom-up, channels interleaved float32. */
AJAR_API ajar_result ajar_job_layer_size(ajar_job job, uint32_t page, uint32_t layer, uint32_t* out_width,
                                         uint32_t* out_height, uint32_t* out_channels);
/* Copies a layer into buffer of float_count floats. */
AJAR_API ajar_result ajar_job_read_layer(ajar_job job, uint32_t page, uint32_t layer, float* buffer,
                                         uint64_t float_count);
/* One term of the baked light, a product of elements (algorithms in Seyb et al. 2020, "The Design
 * and Evolution of the UberBake Light Baking System"): light at any texel is the sum over terms of
 * irradiance times the weights of the term's elements. Term 0 is the product of none: the light with
 * all weights at 0. The bake and the package hold the same polynomial expanded around the weights at
 * the start, which makes that state exact; here it is multiplied out. */
typedef struct ajar_term_info {
    uint32_t struct_size;
    uint32_t element_count;
    uint32_t elements[AJAR_MAX_TERM_ELEMENTS]; /* element ids, ascending */
    uint32_t is_signed;                        /* 1: takes light away somewhere */
    uint64_t texel_count;                      /* texels that keep it */
    float relative_error; /* estimated standard error over the texels it keeps, relative to their mean */
    float discarded;      /* share of the term's light at texels that do not keep it */
} ajar_term_info;
AJAR_API void ajar_term_info_init(ajar_term_info* info);
AJAR_API ajar_result ajar_job_term_count(ajar_job job, uint32_t* out_count);
AJAR_API ajar_result ajar_job_term(ajar_job job, uint32_t term, ajar_term_info* out_info);
/* One page of a term's irradiance, 3 floats per texel, W/m^2, 0 where it is not kept; rows bottom-up. */
AJAR_API ajar_result ajar_job_read_term(ajar_job job, uint32_t term, uint32_t page, float* buffer,
                                        uint64_t float_count);
/* Report as UTF-8 JSON (schemas/report.schema.json). *size holds the buffer's size, and after the
 * call the size needed including the NUL; buffer may be NULL to ask. */
AJAR_API ajar_result ajar_job_report(ajar_job job, char* buffer, uint64_t* size);

/* Writes the package (manifest.json, images) to directory: into a temporary sibling first, then
 * swapped in whole; an older package there is replaced only by a complete one. extras is a JSON
 * object merged into the manifest as "extras", or NULL. */
AJAR_API ajar_result ajar_job_write_package(ajar_job job, const char* directory, const char* extras);

/* ---- reference ---------------------------------------------------------------------------- */

/* How points are chosen: all lightmapped surface alike, or all texels alike. */
enum { AJAR_CHOICE_AREA = 0, AJAR_CHOICE_TEXEL = 1 };
#define AJAR_REFERENCE_MIN_BATCHES 4u
#define AJAR_REFERENCE_BATCH_PATHS 64u

/* Brute force answers to judge bakes by: irradiance at random points of the lightmapped surfaces by
 * path tracing that shares no sampling, storage or shortcut with the bake. Its physics are the same:
 * bounces, roles, sides of surfaces, tinted shadows, light sets, doors and toggles. */
typedef struct ajar_reference_settings {
    uint32_t struct_size;
    uint32_t points;     /* 1..1048576 */
    uint32_t bounces;    /* as in ajar_settings */
    uint32_t batches;    /* most batches of AJAR_REFERENCE_BATCH_PATHS paths per point, >= AJAR_REFERENCE_MIN_BATCHES */
    float time_limit;    /* s; no batch starts after it once AJAR_REFERENCE_MIN_BATCHES are done; 0 = none */
    uint32_t seed;       /* of the paths */
    uint32_t point_seed; /* of the choice of points */
    uint32_t threads;    /* 0 = all */
    uint32_t choice;     /* AJAR_CHOICE_* */
    uint32_t texel_mean; /* 0: light at the point itself; 1: mean over its texel, which no wall parts */
    float normal[3];     /* receiver's normal in the tangent frame, 0 0 1 = the surface's own; unit, z > 0 */
    uint32_t weight_count; /* 0, or the number of elements */
    const float* weights;  /* [weight_count] state of every element; weight_count 0: as at the start */
    uint32_t door_bounces; /* reflections that light may have had behind an open door to count, AJAR_NONE: any. To
                              judge bakers that stop there (Seyb et al. 2020 at 1); such light is then missing */
} ajar_reference_settings;
AJAR_API void ajar_reference_settings_init(ajar_reference_settings* settings);

typedef struct ajar_reference_point {
    uint32_t page, x, y;         /* texel, y counted from the bottom */
    uint32_t instance, triangle; /* surface: instance id, triangle of its mesh */
    float u, v;                  /* barycentric weights of the triangle's corners 1 and 2 */
    float irradiance[3];         /* W/m^2 */
    float standard_error;        /* of its luminance, W/m^2, from the spread of the batches */
} ajar_reference_point;

/* Starts tracing a committed scene on the library's own threads. */
AJAR_API ajar_result ajar_reference_start(ajar_scene scene, const ajar_reference_settings* settings,
                                          ajar_reference* out_reference);
/* These five are to a reference what ajar_job_* are to a bake; rays counts paths. */
AJAR_API ajar_result ajar_reference_poll(ajar_reference reference, ajar_progress* out_progress);
AJAR_API ajar_result ajar_reference_cancel(ajar_reference reference);
AJAR_API ajar_result ajar_reference_wait(ajar_reference reference, double timeout);
AJAR_API ajar_result ajar_reference_error(ajar_reference reference, char* text, uint64_t text_size, char* culprit,
                                          uint64_t culprit_size);
AJAR_API ajar_result ajar_reference_release(ajar_reference* reference);
/* Copies all points of a finished reference into points, which holds point_count of them, and the
 * number of batches behind each into *out_batches. */
AJAR_API ajar_result ajar_reference_read(ajar_reference reference, ajar_reference_point* points, uint64_t point_count,
                                         uint32_t* out_batches);

/* ---- lightmap UV layout ------------------------------------------------------------------- */

typedef struct ajar_layout_settings {
    uint32_t struct_size;
    float texels_per_meter;
    uint32_t atlas_size; /* largest page edge, texels */
    uint32_t padding;    /* texels kept free between charts */
    float chart_angle;   /* radians a face normal may leave its chart's axis */
} ajar_layout_settings;
AJAR_API void ajar_layout_settings_init(ajar_layout_settings* settings);

/* One mesh to lay out. Polygons are runs of corners. */
typedef struct ajar_layout_mesh_desc {
    uint32_t struct_size;
    const char* name;
    uint32_t vertex_count, corner_count, polygon_count;
    const float* positions;           /* [vertex_count][3], local space */
    const uint32_t* corner_vertex;    /* [corner_count] */
    const uint32_t* polygon_start;    /* [polygon_count] first corner */
    const uint32_t* polygon_size;     /* [polygon_count] corners, >= 3 */
    const uint8_t* corner_edge_sharp; /* [corner_count] edge to the next corner is sharp, or NULL */
    const float* corner_uv;           /* [corner_count][2] charts to keep, or NULL: unwrap */
    uint32_t user_count;              /* instances of this mesh */
    const double* user_transforms;    /* [user_count][12] row-major 3x4 */
    const float* user_texel_scale;    /* [user_count] or NULL: 1 */
} ajar_layout_mesh_desc;
AJAR_API void ajar_layout_mesh_desc_init(ajar_layout_mesh_desc* desc);

AJAR_API ajar_result ajar_layout_create(const ajar_layout_settings* settings, ajar_layout* out_layout);
AJAR_API ajar_result ajar_layout_release(ajar_layout* layout);
AJAR_API ajar_result ajar_layout_add_mesh(ajar_layout layout, const ajar_layout_mesh_desc* desc, uint32_t* out_id);
/* Unwraps and packs everything added. */
AJAR_API ajar_result ajar_layout_run(ajar_layout layout);
AJAR_API ajar_result ajar_layout_page_count(ajar_layout layout, uint32_t* out_count);
AJAR_API ajar_result ajar_layout_page_size(ajar_layout layout, uint32_t page, uint32_t* out_width,
                                           uint32_t* out_height);
/* Lightmap UVs of a mesh: corner_count*2 floats in [0,1]. With one user they are page UVs. */
AJAR_API ajar_result ajar_layout_mesh_uv(ajar_layout layout, uint32_t mesh, float* buffer, uint64_t float_count);
/* Where a user of a mesh lies: page UV = uv * scale + offset. */
AJAR_API ajar_result ajar_layout_user(ajar_layout layout, uint32_t mesh, uint32_t user, uint32_t* out_page,
                                      float out_scale[2], float out_offset[2], float* out_texels_per_meter);
AJAR_API ajar_result ajar_layout_warning_count(ajar_layout layout, uint32_t* out_count);
AJAR_API ajar_result ajar_layout_warning(ajar_layout layout, uint32_t index, char* text, uint64_t text_size,
                                         char* culprit, uint64_t culprit_size);

#ifdef __cplusplus
}
#endif
#endif /* AJAR_AJAR_H */
