// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "ajar/ajar.h"
#include "base/error.h"
#include "receiver/page_plan.h"

namespace ajar {

/// Where one user (instance) of a mesh lies: page UV = mesh UV * scale + offset.
struct LayoutUser {
    uint32_t page = AJAR_NONE; ///< AJAR_NONE for a mesh without polygons
    float scale[2] = {1.0f, 1.0f};
    float offset[2] = {0.0f, 0.0f};
    float texels_per_meter = 0.0f; ///< reached, in world space
};

/// Lightmap UVs for a set of meshes: unwraps (or keeps) charts and packs them into pages.
/// Charts of one user share a page and lie `padding` free texels apart and from the border.
/// A mesh with one user gets page UVs; one with several gets UVs of a rectangle placed per user.
/// Used from one thread. Every input is copied. Throws ajar::Error.
class Layout {
public:
    explicit Layout(const ajar_layout_settings& settings);
    ~Layout();
    Layout(Layout&&) noexcept;
    Layout& operator=(Layout&&) noexcept;

    /// Returns the mesh's id, counted from 0.
    uint32_t add_mesh(const ajar_layout_mesh_desc& desc);
    /// Unwraps and packs everything added; once.
    void run();

    uint32_t page_count() const;
    PageSize page_size(uint32_t page) const;
    /// [corner_count][2] in [0,1].
    std::span<const float> mesh_uv(uint32_t mesh) const;
    LayoutUser user(uint32_t mesh, uint32_t user) const;
    const std::vector<Warning>& warnings() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace ajar
