// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// A small door far away, for the test and the benchmark of rays that aim at doors.

#include <cmath>
#include <utility>

#include "scene_kit.h"

namespace kit {

/// A dark hall, 14 m long, with a small door at its far end, and a bright room behind that.
struct DoorHall {
    static constexpr uint32_t kSize = 16;
    Scene scene;
    uint32_t page; ///< of the hall's end, which looks at the door

    DoorHall() {
        const uint32_t grey = scene.diffuse({0.4f, 0.4f, 0.4f});
        MeshData end;
        end.quad({-1.9f, 0.01f, 0.1f}, {1.9f, 0.01f, 0.1f}, {1.9f, 0.01f, 2.4f}, {-1.9f, 0.01f, 2.4f}, {0, 0}, {1, 1});
        std::swap(end.corners[1], end.corners[2]), std::swap(end.corners[4], end.corners[5]);
        page = scene.page(kSize, kSize);
        scene.instance(scene.mesh(end), grey, page);
        add(without(box({-2, 0, 0}, {2, 14, 2.5f}, true), 4), grey);
        add(without(box({-2, 14.2f, 0}, {2, 20, 2.5f}, true), 2), grey);
        add(box({-2.1f, 14, -0.1f}, {-0.25f, 14.2f, 2.6f}, false), grey);
        add(box({0.25f, 14, -0.1f}, {2.1f, 14.2f, 2.6f}, false), grey);
        add(box({-0.25f, 14, -0.1f}, {0.25f, 14.2f, 0.5f}, false), grey);
        add(box({-0.25f, 14, 1.2f}, {0.25f, 14.2f, 2.6f}, false), grey);
        scene.current_switch = scene.element(AJAR_ELEMENT_DOOR, "door");
        add(box({-0.26f, 13.95f, 0.49f}, {0.26f, 13.99f, 1.21f}, false), grey);
        scene.current_switch = AJAR_NONE;
        scene.point_light({1.5f, 15, 2}, 400.0f, 0.05f, true);
        scene.commit();
    }
    /// Every texel of the hall's end, green channel of the door's term. All bakes have one seed, so that
    /// their bounces are the same whatever the final rays.
    std::vector<double> bake(uint32_t samples, float door_rays) const {
        ajar_settings s = settings(3, samples);
        s.positions_per_texel = 4;
        s.door_rays = door_rays;
        s.term_threshold = 0.0f;
        const Bake baked(scene, s);
        const Layer l = baked.term(1, kSize, kSize, page);
        std::vector<double> out;
        for (uint32_t i = 0; i < kSize * kSize; ++i) out.push_back(l.data[3 * i + 1]);
        return out;
    }

private:
    /// A box without one of its faces.
    static MeshData without(MeshData box, int face) {
        const auto first = static_cast<ptrdiff_t>(6 * face);
        box.corners.erase(box.corners.begin() + first, box.corners.begin() + first + 6);
        box.uv.erase(box.uv.begin() + first, box.uv.begin() + first + 6);
        return box;
    }
    void add(const MeshData& data, uint32_t material) {
        scene.instance(scene.mesh(data), material, scene.page(24, 24));
    }
};

/// Some answers against the truth: means, and the root mean square difference over the true mean.
struct Comparison {
    double mean = 0.0, expected = 0.0, rms = 0.0;
};

inline Comparison compare(const std::vector<double>& a, const std::vector<double>& truth) {
    Comparison c;
    for (size_t i = 0; i < a.size(); ++i) {
        c.mean += a[i] / double(a.size());
        c.expected += truth[i] / double(a.size());
        c.rms += (a[i] - truth[i]) * (a[i] - truth[i]) / double(a.size());
    }
    c.rms = std::sqrt(c.rms) / c.expected;
    return c;
}

} // namespace kit
