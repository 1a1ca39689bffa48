// SPDX-License-Identifier: Apache-2.0
#include "light_patch.h"

#include <cmath>

#include "error.h"
#include "texel.h"

namespace ajar::runtime {
namespace {

bool fits(uint32_t first, uint32_t count, uint32_t whole) { return first <= whole && count <= whole - first; }

} // namespace

void add_patch(const ajar_runtime_patch& patch, const uint16_t* atlas, uint32_t atlas_width, uint32_t atlas_height,
               const float factor[3], float* light, uint32_t width, uint32_t height) {
    if (patch.channel > 3 || !fits(patch.atlas_x, patch.width, atlas_width) ||
        !fits(patch.atlas_y, patch.height, atlas_height))
        throw Error(AJAR_RUNTIME_ERROR_ARGUMENT, "the patch lies outside its atlas");
    if (!fits(patch.page_x, patch.width, width) || !fits(patch.page_y, patch.height, height))
        throw Error(AJAR_RUNTIME_ERROR_ARGUMENT, "the patch lies outside its page");
    for (int c = 0; c < 3; ++c)
        if (!std::isfinite(factor[c])) throw Error(AJAR_RUNTIME_ERROR_ARGUMENT, "a factor is not finite");
    for (size_t y = 0; y < patch.height; ++y) {
        const uint16_t* from = atlas + 4 * ((patch.atlas_y + y) * atlas_width + patch.atlas_x) + patch.channel;
        float* to = light + 3 * ((patch.page_y + y) * width + patch.page_x);
        for (size_t x = 0; x < patch.width; ++x, from += 4, to += 3) {
            const float value = unpack_half(*from);
            for (int c = 0; c < 3; ++c) to[c] += factor[c] * value;
        }
    }
}

} // namespace ajar::runtime
