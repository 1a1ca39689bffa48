/* SPDX-License-Identifier: GPL-3.0-or-later
 * The header as a C99 program sees it; built with -std=c99 -pedantic -Werror. */
#include <stddef.h>

#include "ajar/ajar.h"

/* Every struct must begin with its size, or init and check would look elsewhere. */
#define BEGINS_WITH_SIZE(type) typedef char type##_begins_with_size[offsetof(type, struct_size) == 0 ? 1 : -1]
BEGINS_WITH_SIZE(ajar_texture_desc);
BEGINS_WITH_SIZE(ajar_material_desc);
BEGINS_WITH_SIZE(ajar_mesh_desc);
BEGINS_WITH_SIZE(ajar_instance_desc);
BEGINS_WITH_SIZE(ajar_light_desc);
BEGINS_WITH_SIZE(ajar_sky_desc);
BEGINS_WITH_SIZE(ajar_settings);
BEGINS_WITH_SIZE(ajar_progress);
BEGINS_WITH_SIZE(ajar_reference_settings);
BEGINS_WITH_SIZE(ajar_layout_settings);
BEGINS_WITH_SIZE(ajar_layout_mesh_desc);

/* Struct sizes as C lays them out, for comparison with C++. */
size_t ajar_test_c_size_of_closure(void);
size_t ajar_test_c_size_of_settings(void);
ajar_result ajar_test_c_empty_bake(void);

size_t ajar_test_c_size_of_closure(void) { return sizeof(ajar_closure); }
size_t ajar_test_c_size_of_settings(void) { return sizeof(ajar_settings); }

/* A bake of nothing: the calls a C host makes, in order. Returns the job's result. */
ajar_result ajar_test_c_empty_bake(void) {
    ajar_scene scene = NULL;
    ajar_job job = NULL;
    ajar_settings settings;
    ajar_result result = ajar_scene_create("from C", &scene);
    ajar_settings_init(&settings);
    if (result == AJAR_OK) result = ajar_scene_commit(scene);
    if (result == AJAR_OK) result = ajar_job_start(scene, &settings, &job);
    if (result == AJAR_OK) result = ajar_job_wait(job, -1.0);
    if (job != NULL) ajar_job_release(&job);
    if (scene != NULL) ajar_scene_release(&scene);
    return result;
}
