// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Reduces bakes to a few hundred numbers that can be kept in a file: light of regions and its noise.

#include <array>
#include <string>
#include <vector>

#include "golden_scenes.h"
#include "statistics.h"

namespace golden {

using Color = std::array<double, 3>;

/// Place of a region: a term ("base", "left*door"), a page of it, and a block of texels there or, as
/// `whole`, all of the page.
struct Region {
    std::string term;
    uint32_t page = 0, x = 0, y = 0;
    bool whole = false;
    bool operator==(const Region&) const = default;
    std::string text() const;
};

/// What one region's light was over several bakes. W/m^2.
struct RegionLight {
    Region region;
    uint32_t texels = 0;   ///< covered ones
    Color mean{}, error{}; ///< over bakes, and its standard error
    Color deviation{};     ///< of one bake's region mean
    double noise = 0.0;    ///< variance of one texel's luminance, mean over the texels
};

/// Bakes a scene with these settings and this seed.
kit::Bake bake(const GoldenScene& scene, ajar_settings settings, uint32_t seed);

/// Sums bakes of one scene that differ by their seed only.
class Measurement {
public:
    explicit Measurement(const GoldenScene& scene) : scene_(scene) {}

    /// Adds a bake; a product that it has no term for is dark. Throws std::runtime_error if it
    /// covers other texels than those before.
    void add(const kit::Bake& bake);
    uint32_t count() const { return static_cast<uint32_t>(bakes_.size()); }
    std::vector<RegionLight> regions() const;
    /// Region means of each bake, in the order of regions().
    const std::vector<std::vector<Color>>& bakes() const { return bakes_; }

private:
    struct Place {
        Region region;
        std::vector<uint32_t> texels; ///< numbers into noise_
        bool operator==(const Place&) const = default;
    };
    /// layer: the light of one product on the page that `whole` names.
    void add_page(const kit::Layer& layer, const kit::Layer& validity, Region whole, std::vector<Place>& places,
                  std::vector<Color>& light);

    const GoldenScene& scene_;
    std::vector<Place> places_;
    std::vector<kit::Sample> noise_; ///< luminance of every texel of every term
    uint32_t next_texel_ = 0;
    std::vector<std::vector<Color>> bakes_;
};

/// Light too faint to matter, W/m^2: a share of what the base has on average. Less than that may come
/// through the joints of touching boxes once in thousands of bakes, which no variance tells of.
double faint_light(const std::vector<RegionLight>& golden);

/// Standard deviation that a mean of `averaged` bakes is expected to have from the golden mean, with
/// the rounding of float images and faint light as the least.
double expected_deviation(const RegionLight& golden, int channel, double averaged, double faint);

/// Sum over blocks and colours of squared deviations from the golden mean, each in units of its
/// variance. `averaged`: bakes behind each mean.
double chi_square(const std::vector<RegionLight>& golden, const std::vector<Color>& light, double averaged);

} // namespace golden
