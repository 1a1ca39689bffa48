// SPDX-License-Identifier: GPL-3.0-or-later
// What a door takes from a rounded base as it closes: all of it where it takes all, to the bit, and else as exactly as
// half floats tell.
#include <gtest/gtest.h>

#include "encode/ahd.h"
#include "runtime_kit.h"

namespace ajar {
namespace {

constexpr uint32_t kSize = 32;

/// Light of a door that starts open and then closes to a share of it, through the package.
std::vector<double> closed(float left, std::vector<float>& open) {
    kit::TermScene scene(5);
    scene.add_page(kSize, kSize);
    scene.add_element("door", "door", 1.0f);
    open.assign(scene.content.pages[0].irradiance.begin(), scene.content.pages[0].irradiance.end());
    std::vector<float> taken;
    for (const float v : open) taken.push_back(-(1.0f - left) * v);
    scene.add_term({0}, kit::texel_range(0, kSize * kSize), taken,
                   std::vector<uint32_t>(kSize * kSize, pack_direction({})), true);
    kit::PackageFolder folder(scene);
    kit::Runtime runtime(folder.path());
    runtime.set_weight(0, 0.0f);
    runtime.update();
    std::vector<double> out;
    const kit::PageWords page = runtime.page(0);
    for (uint32_t y = 0; y < kSize; ++y) // words have their top row first
        for (uint32_t x = 0; x < kSize; ++x) {
            const Vec3 e = unpack_r11g11b10f(page.irradiance[size_t{kSize - 1 - y} * kSize + x]);
            out.insert(out.end(), {e.x, e.y, e.z});
        }
    return out;
}

TEST(RoundedBase, WhatTakesAllLeavesNothing) {
    std::vector<float> open;
    for (const double e : closed(0.0f, open)) ASSERT_EQ(e, 0.0);
    for (const double e : closed(0.0005f, open)) ASSERT_EQ(e, 0.0) << "less than half floats tell";
}

TEST(RoundedBase, WhatIsLeftIsAsExactAsItsFormat) {
    std::vector<float> open;
    const std::vector<double> got = closed(0.01f, open);
    for (size_t i = 0; i < got.size(); ++i) {
        // a half float's 2^-11 of what is taken, and the result's own 2^-7 (blue 2^-6), on top of the base's; below
        // 2^-14 steps are even
        const double wanted = 0.01 * open[i], step = i % 3 == 2 ? 0x1p-6 : 0x1p-7;
        ASSERT_NEAR(got[i], wanted, 2.0 * step * wanted + 0x1p-11 * open[i] + 0x1p-20) << i;
    }
}

} // namespace
} // namespace ajar
