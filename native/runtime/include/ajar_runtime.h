/* SPDX-License-Identifier: Apache-2.0
 *
 * ajar_runtime.h - baked light that changes in a game: opens a package of Ajar, takes the weights of
 * its light sets, doors and toggles, and keeps the lightmap pages up to date. Valid C99 and C++.
 *
 *     ajar_runtime light;
 *     uint32_t lamp;
 *     ajar_runtime_open("level/package", &light);
 *     ajar_runtime_find_element(light, "corridor lamps", &lamp);
 *     ajar_runtime_set_weight(light, lamp, 0.3f);
 *     ajar_runtime_update(light, NULL);         // then upload the pages that changed
 *     ajar_runtime_release(&light);
 *
 * Conventions
 *   Light      of a texel is base + sum over terms of (product of the variables of the term's
 *              elements) * light of the term. The variable of a light set is its weight, that of a
 *              door or toggle its distance from the weight that it starts with: the base is the
 *              light with all sets off and doors and toggles as they start. An update computes the texels that a change
 * reaches anew from the base: the result depends on the weights alone, not on how they came about, and is the same to
 * the bit on every machine. Rows       pages have their top row first, as their DDS files do; where a function says
 *              otherwise, it says so.
 *   Errors     each fallible function returns an ajar_runtime_result (0 = success). The message of
 *              the last failure on this thread is valid until the next call on it.
 *   Structs    begin with struct_size; fill them with the matching *_init function first.
 *   Handles    are checked: NULL, stale and foreign values give AJAR_RUNTIME_ERROR_HANDLE.
 *   Threads    one runtime is used from one thread at a time, from any. No function calls back,
 *              prints, throws or exits, and no thread is started.
 *   Files      of the package must not be changed in place while it is open. Replacing the folder
 *              or a file whole, as a bake does, is safe.
 */
#ifndef AJAR_RUNTIME_H
#define AJAR_RUNTIME_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#define AJAR_RUNTIME_API __declspec(dllexport)
#else
#define AJAR_RUNTIME_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define AJAR_RUNTIME_ABI_VERSION 1u

typedef int32_t ajar_runtime_result;
enum {
    AJAR_RUNTIME_OK = 0,
    AJAR_RUNTIME_ERROR_ARGUMENT = -1,    /* null pointer, index or weight out of range, NaN */
    AJAR_RUNTIME_ERROR_STRUCT_SIZE = -2, /* struct_size is not one this library knows */
    AJAR_RUNTIME_ERROR_HANDLE = -3,      /* null, stale or foreign handle */
    AJAR_RUNTIME_ERROR_NOT_FOUND = -4,   /* no element of that name */
    AJAR_RUNTIME_ERROR_DATA = -5,        /* a file is damaged, cut short or of another version */
    AJAR_RUNTIME_ERROR_MEMORY = -6,
    AJAR_RUNTIME_ERROR_IO = -7,
    AJAR_RUNTIME_ERROR_BUFFER = -8, /* caller's buffer is of wrong size */
    AJAR_RUNTIME_ERROR_INTERNAL = -10
};

typedef struct ajar_runtime_impl* ajar_runtime;

/* ---- library ------------------------------------------------------------------------------ */

/* AJAR_RUNTIME_ABI_VERSION of the loaded library; check it before anything else. */
AJAR_RUNTIME_API uint32_t ajar_runtime_abi_version(void);
/* Short English text for a result code; never NULL. Static storage. */
AJAR_RUNTIME_API const char* ajar_runtime_result_text(ajar_runtime_result code);
/* Message of the last failure on this thread; "" if none. */
AJAR_RUNTIME_API const char* ajar_runtime_error_message(void);

/* ---- package ------------------------------------------------------------------------------ */

/* Opens the package in a directory (UTF-8 path) after checking every byte that it will use.
 * Elements have their start weights; pages show the base light until the first update. A package
 * without elements opens too, and never changes. */
AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_open(const char* directory, ajar_runtime* out_runtime);
/* Frees it and sets *runtime to NULL. Pointers into it become invalid. */
AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_release(ajar_runtime* runtime);

/* ---- elements ----------------------------------------------------------------------------- */

enum { AJAR_RUNTIME_LIGHT_SET = 0, AJAR_RUNTIME_DOOR = 1, AJAR_RUNTIME_TOGGLE = 2 };

typedef struct ajar_runtime_element {
    uint32_t struct_size;
    uint32_t kind;    /* AJAR_RUNTIME_LIGHT_SET, ... */
    const char* name; /* UTF-8, valid until release */
    float weight;     /* as last set */
    float start_weight;
    float color[3];      /* as last set; 1 1 1 for doors and toggles */
    uint32_t dispatches; /* groups of texels that a change updates */
    uint64_t texels;     /* texels in them */
} ajar_runtime_element;
AJAR_RUNTIME_API void ajar_runtime_element_init(ajar_runtime_element* element);

AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_element_count(ajar_runtime runtime, uint32_t* out_count);
AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_get_element(ajar_runtime runtime, uint32_t element,
                                                              ajar_runtime_element* out_element);
/* Index of the first element of that name, or AJAR_RUNTIME_ERROR_NOT_FOUND. */
AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_find_element(ajar_runtime runtime, const char* name,
                                                               uint32_t* out_element);
/* Strength of a light set, any finite number from 0 (1: as baked); openness of a door or presence
 * of a toggle, 0 to 1. Anything else is refused and changes nothing. */
AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_set_weight(ajar_runtime runtime, uint32_t element, float weight);
/* Colour of a light set relative to the bake: its light is multiplied by weight * color. Finite,
 * not negative. */
AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_set_color(ajar_runtime runtime, uint32_t element,
                                                            const float color[3]);
/* Openness of a hinged leaf at an angle from closed, relative to the angle it was baked open at;
 * radians, either sign, 0 to 1. Diffuse light through a slit between leaf and frame grows with
 * sin(angle / 2): the view factor of the opening through the gap, by Hottel's crossed strings. */
AJAR_RUNTIME_API float ajar_runtime_door_openness(float angle, float open_angle);

/* ---- update ------------------------------------------------------------------------------- */

typedef struct ajar_runtime_stats {
    uint32_t struct_size;
    uint32_t dispatches; /* groups of texels that were updated */
    uint64_t texels;     /* texels in them */
    uint32_t pages;      /* pages that changed */
} ajar_runtime_stats;
AJAR_RUNTIME_API void ajar_runtime_stats_init(ajar_runtime_stats* stats);

/* Brings the pages up to the weights. Costs time only for the texels that a changed weight reaches.
 * out_stats may be NULL. */
AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_update(ajar_runtime runtime, ajar_runtime_stats* out_stats);

/* ---- pages -------------------------------------------------------------------------------- */

/* Box of texels, from the top left corner of the page. */
typedef struct ajar_runtime_rect {
    uint32_t x, y, width, height;
} ajar_runtime_rect;

AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_page_count(ajar_runtime runtime, uint32_t* out_count);
AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_page_size(ajar_runtime runtime, uint32_t page, uint32_t* out_width,
                                                            uint32_t* out_height);
/* Box around the texels of a page that the last update may have changed; width 0 if none. */
AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_page_dirty(ajar_runtime runtime, uint32_t page,
                                                             ajar_runtime_rect* out_rect);
/* The page's texels, width * height words each, top row first, without gaps: R11G11B10F irradiance
 * (in units of ajar_runtime_page_scale) and RGBA8 direction and ratio, as in the page's DDS files. Valid until release;
 * updates write to them. */
AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_page_texels(ajar_runtime runtime, uint32_t page,
                                                              const uint32_t** out_irradiance,
                                                              const uint32_t** out_direction);
/* W/m^2 that 1 in a page's irradiance texels stands for: 1, but for scenes that are very dim or bright as a
 * whole. Shaders multiply by it; ajar_runtime_read_irradiance has done so. */
AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_page_scale(ajar_runtime runtime, uint32_t page, float* out_scale);
/* Irradiance along the surface normal in W/m^2 as floats, BOTTOM row first as Blender's and OpenGL's
 * images are: channels is 3 (RGB) or 4 (RGBA, alpha 1); float_count = width * height * channels. */
AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_read_irradiance(ajar_runtime runtime, uint32_t page,
                                                                  uint32_t channels, float* buffer,
                                                                  uint64_t float_count);

/* ---- light patches ------------------------------------------------------------------------ */

/* A package can also hold the layout of "Semi-Dynamic Light Maps" (patches.json), for engines that
 * blend plain textures. This is all that it takes on a processor, apart from any runtime: */

/* A patch as patches.json lists it. */
typedef struct ajar_runtime_patch {
    uint32_t struct_size;
    uint32_t page_x, page_y, width, height;
    uint32_t atlas_x, atlas_y, channel;
} ajar_runtime_patch;
AJAR_RUNTIME_API void ajar_runtime_patch_init(ajar_runtime_patch* patch);
/* light += factor * patch. atlas: the texels of its DDS file, [atlas_height][atlas_width][4] half
 * floats; light: [height][width][3] floats, the page that the patch belongs to, top row first.
 * Sums are linear, so with the map's scale and colour in factor this is each of the paper's steps:
 * factor 1 on black copies a map together (algorithms 5, 6), intensity adds a light (7), - intensity
 * takes an object's shadow off (3.3.3), new less old intensity updates it (8, 9). Cut negative light to 0
 * once, where the page is packed. Fails without a change for a patch that does not fit or a factor
 * that is not finite. */
AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_add_patch(const ajar_runtime_patch* patch, const uint16_t* atlas,
                                                            uint32_t atlas_width, uint32_t atlas_height,
                                                            const float factor[3], float* light, uint32_t width,
                                                            uint32_t height);

/* ---- update on a graphics card ------------------------------------------------------------ */

/* What ajar_terms.comp reads, for buffers that are filled once. Valid until release. */
typedef struct ajar_runtime_buffers {
    uint32_t struct_size;
    uint32_t dispatch_count, term_count;
    const uint32_t* dispatches; /* 16 words each */
    const uint32_t* palette;    /* term ids, two to a word */
    const uint32_t* data;
    uint64_t palette_words, data_words;
} ajar_runtime_buffers;
AJAR_RUNTIME_API void ajar_runtime_buffers_init(ajar_runtime_buffers* buffers);
AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_get_buffers(ajar_runtime runtime, ajar_runtime_buffers* out_buffers);

/* What the shader has to do now; valid until the next call on the runtime that changes or updates it. */
typedef struct ajar_runtime_work {
    uint32_t struct_size;
    uint32_t group_count;      /* work groups */
    const uint32_t* groups;    /* [group_count][2]: dispatch, first receiver */
    const float* term_weights; /* [term_count][4]: RGB weight of each term, 0 */
    ajar_runtime_stats stats;
} ajar_runtime_work;
AJAR_RUNTIME_API void ajar_runtime_work_init(ajar_runtime_work* work);
/* Instead of ajar_runtime_update: counts the changes as done and says what to run for them, in work
 * groups of AJAR_RUNTIME_GROUP_SIZE receivers. The pages of the runtime itself stay as they are, so use
 * one of the two for a runtime, not both. */
AJAR_RUNTIME_API ajar_runtime_result ajar_runtime_plan_update(ajar_runtime runtime, ajar_runtime_work* out_work);
#define AJAR_RUNTIME_GROUP_SIZE 64u

#ifdef __cplusplus
}
#endif
#endif /* AJAR_RUNTIME_H */
