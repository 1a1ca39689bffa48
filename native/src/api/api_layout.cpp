// SPDX-License-Identifier: GPL-3.0-or-later
// ajar_layout_*: check, guard, forward.
#include "api/guard.h"
#include "api/tables.h"

using namespace ajar;

extern "C" {

AJAR_API ajar_result ajar_layout_create(const ajar_layout_settings* settings, ajar_layout* out) {
    return guarded([&] {
        ajar_layout& handle = required(out);
        handle = static_cast<ajar_layout>(layouts().add(std::make_shared<Layout>(checked(settings))));
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_layout_release(ajar_layout* layout) {
    return guarded([&] {
        layouts().take(required(layout));
        *layout = nullptr;
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_layout_add_mesh(ajar_layout layout, const ajar_layout_mesh_desc* desc, uint32_t* out_id) {
    return guarded([&] {
        const auto l = layouts().get(layout);
        uint32_t& id = required(out_id);
        id = l->add_mesh(checked(desc));
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_layout_run(ajar_layout layout) {
    return guarded([&] {
        layouts().get(layout)->run();
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_layout_page_count(ajar_layout layout, uint32_t* out) {
    return guarded([&] {
        required(out) = layouts().get(layout)->page_count();
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_layout_page_size(ajar_layout layout, uint32_t page, uint32_t* width, uint32_t* height) {
    return guarded([&] {
        const auto size = layouts().get(layout)->page_size(page);
        required(width) = size.width;
        required(height) = size.height;
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_layout_mesh_uv(ajar_layout layout, uint32_t mesh, float* buffer, uint64_t float_count) {
    return guarded([&] {
        const auto l = layouts().get(layout);
        const auto uv = l->mesh_uv(mesh);
        if (float_count < uv.size() || (buffer == nullptr && !uv.empty()))
            throw Error(AJAR_ERROR_BUFFER, "the buffer holds fewer floats than the mesh has UVs");
        if (!uv.empty()) std::memcpy(buffer, uv.data(), uv.size_bytes());
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_layout_user(ajar_layout layout, uint32_t mesh, uint32_t user, uint32_t* page, float scale[2],
                                      float offset[2], float* density) {
    return guarded([&] {
        const LayoutUser u = layouts().get(layout)->user(mesh, user);
        if (scale == nullptr || offset == nullptr) throw Error(AJAR_ERROR_ARGUMENT, "an output pointer is null");
        required(page) = u.page;
        std::memcpy(scale, u.scale, sizeof(u.scale));
        std::memcpy(offset, u.offset, sizeof(u.offset));
        required(density) = u.texels_per_meter;
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_layout_warning_count(ajar_layout layout, uint32_t* out) {
    return guarded([&] {
        required(out) = static_cast<uint32_t>(layouts().get(layout)->warnings().size());
        return AJAR_OK;
    });
}

AJAR_API ajar_result ajar_layout_warning(ajar_layout layout, uint32_t index, char* text, uint64_t text_size,
                                         char* culprit, uint64_t culprit_size) {
    return guarded([&] {
        const auto l = layouts().get(layout);
        if (index >= l->warnings().size()) throw Error(AJAR_ERROR_ARGUMENT, "there is no warning of that index");
        copy_text(l->warnings()[index].text, text, text_size);
        copy_text(l->warnings()[index].culprit, culprit, culprit_size);
        return AJAR_OK;
    });
}

} // extern "C"
