// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The scenes whose light is kept as golden data, and how they are baked.

#include <memory>
#include <string>
#include <vector>

#include "scene_kit.h"

namespace golden {

struct PageSize {
    uint32_t width, height;
};

/// A committed scene with its settings: golden means come from `fine` bakes, golden noise and the test
/// itself from `tested` ones. Both have fixed numbers of rays: where a pilot decides, a few bakes in
/// a thousand are far noisier than the rest, and tell nothing.
struct GoldenScene {
    explicit GoldenScene(const char* scene_name) : name(scene_name), scene(scene_name) {}

    std::string name;
    kit::Scene scene;
    std::vector<PageSize> pages;
    std::vector<ajar_element_desc> elements; ///< name and kind
    ajar_settings tested{}, fine{};
    uint32_t block = 8;         ///< texels along the edge of a block
    double noise_factor = 1.15; ///< by which the variance of texels may differ from the golden one

    uint32_t page(uint32_t width, uint32_t height);
    uint32_t element(uint32_t kind, const char* element_name);
    /// Every product that a bake may have: at most one light set, any doors and toggles.
    std::vector<std::vector<uint32_t>> products() const;
    /// A box seen from outside on a page of its own, faces of cell x cell texels.
    void slab(kit::Float3 low, kit::Float3 high, uint32_t material, uint32_t cell);
};

/// Every golden scene's name; also that of its data file.
const std::vector<std::string>& scene_names();
/// Builds a scene. Throws std::runtime_error for an unknown name.
std::unique_ptr<GoldenScene> make_scene(const std::string& name);

} // namespace golden
