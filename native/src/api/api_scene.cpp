// SPDX-License-Identifier: GPL-3.0-or-later
// ajar_scene_*: check, guard, forward.
#include "api/guard.h"
#include "api/handles.h"
#include "api/tables.h"

using namespace ajar;

namespace {

template <class Desc, class Add>
ajar_result add(ajar_scene scene, const Desc* desc, uint32_t* out_id, Add&& method) {
    return guarded([&] {
        const auto builder = scenes().get(scene);
        uint32_t& id = required(out_id);
        if (builder->committed()) throw Error(AJAR_ERROR_STATE, "the scene is committed; add to a new one");
        id = (builder.get()->*method)(checked(desc));
        return AJAR_OK;
    });
}

} // namespace

extern "C" {

AJAR_API ajar_result ajar_scene_create(const char* name, ajar_scene* out) {
    return guarded([&] {
        ajar_scene& handle = required(out);
        handle =
            static_cast<ajar_scene>(scenes().add(std::make_shared<SnapshotBuilder>(name != nullptr ? name : "scene")));
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_scene_release(ajar_scene* scene) {
    return guarded([&] {
        scenes().take(required(scene));
        *scene = nullptr;
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_scene_add_texture(ajar_scene s, const ajar_texture_desc* d, uint32_t* id) {
    return add(s, d, id, &SnapshotBuilder::add_texture);
}
AJAR_API ajar_result ajar_scene_add_material(ajar_scene s, const ajar_material_desc* d, uint32_t* id) {
    return add(s, d, id, &SnapshotBuilder::add_material);
}
AJAR_API ajar_result ajar_scene_add_mesh(ajar_scene s, const ajar_mesh_desc* d, uint32_t* id) {
    return add(s, d, id, &SnapshotBuilder::add_mesh);
}
AJAR_API ajar_result ajar_scene_add_element(ajar_scene s, const ajar_element_desc* d, uint32_t* id) {
    return add(s, d, id, &SnapshotBuilder::add_element);
}
AJAR_API ajar_result ajar_scene_add_instance(ajar_scene s, const ajar_instance_desc* d, uint32_t* id) {
    return add(s, d, id, &SnapshotBuilder::add_instance);
}
AJAR_API ajar_result ajar_scene_add_light(ajar_scene s, const ajar_light_desc* d, uint32_t* id) {
    return add(s, d, id, &SnapshotBuilder::add_light);
}

AJAR_API ajar_result ajar_scene_add_page(ajar_scene s, uint32_t width, uint32_t height, uint32_t* out_id) {
    return guarded([&] {
        const auto builder = scenes().get(s);
        if (builder->committed()) throw Error(AJAR_ERROR_STATE, "the scene is committed; add to a new one");
        required(out_id) = builder->add_page(width, height);
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_scene_set_sky(ajar_scene s, const ajar_sky_desc* d) {
    return guarded([&] {
        const auto builder = scenes().get(s);
        if (builder->committed()) throw Error(AJAR_ERROR_STATE, "the scene is committed; add to a new one");
        builder->set_sky(checked(d));
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_scene_commit(ajar_scene s) {
    return guarded([&] {
        scenes().get(s)->commit();
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_scene_warning_count(ajar_scene s, uint32_t* out) {
    return guarded([&] {
        required(out) = static_cast<uint32_t>(scenes().get(s)->warnings().size());
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_scene_warning(ajar_scene s, uint32_t index, char* text, uint64_t text_size, char* culprit,
                                        uint64_t culprit_size) {
    return guarded([&] {
        const auto builder = scenes().get(s);
        if (index >= builder->warnings().size()) throw Error(AJAR_ERROR_ARGUMENT, "there is no warning of that index");
        copy_text(builder->warnings()[index].text, text, text_size);
        copy_text(builder->warnings()[index].culprit, culprit, culprit_size);
        return AJAR_OK;
    });
}

} // extern "C"
