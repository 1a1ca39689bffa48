// SPDX-License-Identifier: GPL-3.0-or-later
#include "stored_light.h"

#include <stdexcept>

#include "ajar_runtime.h"
#include "room_kit.h"

namespace hard {
namespace {

void check(ajar_runtime_result result) {
    if (result != AJAR_RUNTIME_OK) throw std::runtime_error(ajar_runtime_error_message());
}

} // namespace

kit::Layer stored_light(const kit::Bake& bake, std::span<const float> weights, uint32_t page) {
    const kit::TempFolder folder;
    kit::check(ajar_job_write_package(bake.handle(), folder.path("package").c_str(), nullptr));
    ajar_runtime runtime = nullptr;
    check(ajar_runtime_open(folder.path("package").c_str(), &runtime));
    for (uint32_t i = 0; i < weights.size(); ++i) check(ajar_runtime_set_weight(runtime, i, weights[i]));
    check(ajar_runtime_update(runtime, nullptr));
    kit::Layer out;
    out.channels = 3;
    check(ajar_runtime_page_size(runtime, page, &out.width, &out.height));
    out.data.resize(size_t{3} * out.width * out.height);
    check(ajar_runtime_read_irradiance(runtime, page, 3, out.data.data(), out.data.size()));
    ajar_runtime_release(&runtime);
    return out;
}

} // namespace hard
