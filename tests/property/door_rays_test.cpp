// SPDX-License-Identifier: GPL-3.0-or-later
// Rays aimed at doors: the same mean, much less noise where a door is small and far.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "scene_kit.h"

namespace {

constexpr uint32_t kSize = 16;

/// A dark hall, 14 m long, with a small door at its far end, and a bright room behind that.
struct Hall {
    kit::Scene scene;
    uint32_t page; ///< of the hall's end, which looks at the door

    Hall() {
        const uint32_t grey = scene.diffuse({0.4f, 0.4f, 0.4f});
        kit::MeshData end;
        end.quad({-1.9f, 0.01f, 0.1f}, {1.9f, 0.01f, 0.1f}, {1.9f, 0.01f, 2.4f}, {-1.9f, 0.01f, 2.4f}, {0, 0}, {1, 1});
        std::swap(end.corners[1], end.corners[2]), std::swap(end.corners[4], end.corners[5]);
        page = scene.page(kSize, kSize);
        scene.instance(scene.mesh(end), grey, page);
        add(without(kit::box({-2, 0, 0}, {2, 14, 2.5f}, true), 4), grey);
        add(without(kit::box({-2, 14.2f, 0}, {2, 20, 2.5f}, true), 2), grey);
        add(kit::box({-2.1f, 14, -0.1f}, {-0.25f, 14.2f, 2.6f}, false), grey);
        add(kit::box({0.25f, 14, -0.1f}, {2.1f, 14.2f, 2.6f}, false), grey);
        add(kit::box({-0.25f, 14, -0.1f}, {0.25f, 14.2f, 0.5f}, false), grey);
        add(kit::box({-0.25f, 14, 1.2f}, {0.25f, 14.2f, 2.6f}, false), grey);
        scene.current_switch = scene.element(AJAR_ELEMENT_DOOR, "door");
        add(kit::box({-0.26f, 13.95f, 0.49f}, {0.26f, 13.99f, 1.21f}, false), grey);
        scene.current_switch = AJAR_NONE;
        scene.point_light({1.5f, 15, 2}, 400.0f, 0.05f, true);
        scene.commit();
    }
    /// Every texel of the hall's end, green channel of the door's term. All bakes have one seed, so that
    /// their bounces are the same whatever the final rays.
    std::vector<double> bake(uint32_t samples, float door_rays) const {
        ajar_settings s = kit::settings(3, samples);
        s.positions_per_texel = 4;
        s.door_rays = door_rays;
        s.term_threshold = 0.0f;
        const kit::Bake baked(scene, s);
        const kit::Layer l = baked.term(1, kSize, kSize, page);
        std::vector<double> out;
        for (uint32_t i = 0; i < kSize * kSize; ++i) out.push_back(l.data[3 * i + 1]);
        return out;
    }

private:
    /// A box without one of its faces.
    static kit::MeshData without(kit::MeshData box, int face) {
        const auto first = static_cast<ptrdiff_t>(6 * face);
        box.corners.erase(box.corners.begin() + first, box.corners.begin() + first + 6);
        box.uv.erase(box.uv.begin() + first, box.uv.begin() + first + 6);
        return box;
    }
    void add(const kit::MeshData& data, uint32_t material) {
        scene.instance(scene.mesh(data), material, scene.page(24, 24));
    }
};

struct Comparison {
    double mean = 0.0, expected = 0.0, rms = 0.0;
};

Comparison compare(const std::vector<double>& a, const std::vector<double>& truth) {
    Comparison c;
    for (size_t i = 0; i < a.size(); ++i) {
        c.mean += a[i] / double(a.size());
        c.expected += truth[i] / double(a.size());
        c.rms += (a[i] - truth[i]) * (a[i] - truth[i]) / double(a.size());
    }
    c.rms = std::sqrt(c.rms) / c.expected;
    return c;
}

TEST(DoorRays, KeepTheMeanAndTakeTheNoise) {
    const Hall hall;
    const std::vector<double> truth = hall.bake(4096, 0.5f);
    const Comparison plain = compare(hall.bake(4096, 0.0f), truth), few = compare(hall.bake(256, 0.0f), truth),
                     aimed = compare(hall.bake(256, 0.25f), truth);
    EXPECT_NEAR(plain.mean / plain.expected, 1.0, 0.12); // three standard errors
    EXPECT_NEAR(aimed.mean / aimed.expected, 1.0, 0.04);
    EXPECT_LT(aimed.rms, 0.15 * few.rms);
}

} // namespace
