// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/error.h"
#include "encode/ahd.h"
#include "package/manifest.h"
#include "pass/bake.h"

namespace ajar {

/// One term over the texels that keep it, sorted by texel (index over all pages).
struct BakedTerm {
    std::vector<uint32_t> elements;
    bool is_signed = false;
    float relative_error = 0.0f, discarded = 0.0f;
    std::vector<uint32_t> texel;
    std::vector<Vec3> irradiance;
    std::vector<uint32_t> packed_direction;
};

/// The bake over all texels of all pages, ready to be stored or read by the caller.
struct BakedPages {
    std::vector<Vec3> irradiance, albedo;
    std::vector<float> standard_error, samples, validity;
    std::vector<float> sh_rgb; ///< [texels][27] or empty
    std::vector<uint32_t> packed_irradiance, packed_direction;
    std::vector<std::vector<Vec3>> bounces;
    std::vector<BakedTerm> terms; ///< all but the base, which the arrays above hold
    double discarded = 0.0;       ///< share of all terms' light at texels that do not keep it
    uint64_t invalid_texels = 0;  ///< covered, but inside a solid; filled from neighbours
    uint64_t seam_points = 0;
    uint64_t clamped_texels = 0; ///< too bright for the packed format
    float scale = 1.0f;          ///< W/m^2 that 1 in packed_irradiance stands for
    std::vector<Warning> warnings;
};

/// Scatters receivers to their texels, stitches seams, fills gaps and packs (algorithms.md 1, 9).
BakedPages make_pages(const Snapshot& scene, const LightmapReceivers& receivers, const BakeResult& result,
                      const ajar_settings& settings, ThreadPool& pool, Progress& progress);

/// View of the pages for the package writer, with what the settings ask for beside them; baked must outlive it.
PackageContent package_content(const Snapshot& scene, const BakedPages& baked, const ajar_settings& settings);

} // namespace ajar
