// SPDX-License-Identifier: GPL-3.0-or-later
#include "pass/twin_check.h"

#include "pass/bake_parts.h"

namespace ajar {

namespace {

constexpr size_t kMostStep = 2;    ///< of many tiles
constexpr size_t kLeastTiles = 16; ///< if there are as many
constexpr size_t kFewParts = 8;
constexpr double kLeastFactor = 0.25, kMostFactor = 4.0;

std::vector<float> levels(const BakeResult& result) {
    if (!result.total.empty()) return result.total;
    std::vector<float> out;
    for (const Vec3& e : result.irradiance) out.push_back(luminance(e));
    return out;
}

size_t step_of(size_t tiles) { return std::clamp<size_t>(tiles / kLeastTiles, 1, kMostStep); }

} // namespace

double check_seconds(size_t tiles, uint32_t bounces, double source, double gather) {
    constexpr double kAnswers = 2.0; // from the bake's source and from the other
    const double checked = double{kPilotReceivers} / kTileReceivers / static_cast<double>(step_of(tiles));
    return (bounces > 0 ? source / TwinCheck::kSourcePart : 0.0) + kAnswers * checked * gather;
}

double seconds_left(const ajar_settings& settings, const Progress& progress, size_t tiles, double source_end) {
    const double source = progress.stage_seconds(AJAR_STAGE_DIRECT) + progress.stage_seconds(AJAR_STAGE_BOUNCES);
    return settings.time_limit - progress.elapsed() -
           check_seconds(tiles, settings.bounces, source, settings.time_limit - source_end);
}

ajar_settings other_source_settings(ajar_settings settings) {
    settings.seed = hash_combine(settings.seed, kSaltTwin);
    settings.bounce_samples = std::max(settings.bounce_samples / TwinCheck::kSourcePart, 1u);
    settings.keep_bounces = settings.keep_sh = 0;
    settings.time_limit = 0.0f;
    return settings;
}

double source_rays_ratio(const ajar_settings& settings) {
    return double(bounce_rays(settings)) / bounce_rays(other_source_settings(settings));
}

uint32_t other_source_samples(const ajar_settings& settings, uint32_t samples) {
    return static_cast<uint32_t>(std::lround(samples / source_rays_ratio(settings)));
}

TwinCheck::TwinCheck(const LightmapReceivers& receivers, const BakeResult& result)
    : receivers_(receivers),
      result_(result),
      step_(step_of(receivers.tiles.size())),
      dark_(dark_level(levels(result))),
      parts_(receivers.tiles.size() / step_) {}

Tile TwinCheck::part(const LightmapReceivers& receivers, size_t i) {
    const Tile& tile = receivers.tiles[i];
    return pilot_part({tile.first, split(receivers, tile).on_charts}, hash32(static_cast<uint32_t>(i)) % kPilotParts);
}

void TwinCheck::compare(size_t k, uint32_t receiver, const Answers& a) {
    if (receivers_.ring[receiver] || result_.inside[receiver] > kInsideShare) return;
    const double scale = 0.5 * (double{a.first} + a.second) + dark_;
    if (!(scale > 0.0)) return;
    const auto half_square = [&](double d) { return std::min(0.5 * d * d / (scale * scale), 1.0); };
    parts_[k].twin += half_square(double{a.first} - a.second);
    parts_[k].other += half_square(double{a.first} - a.other);
    parts_[k].strata += std::min(a.variance / (scale * scale), 1.0);
}

// Half the squared difference of answers from two sources holds the noise of the gather once, and half that of
// both sources. The spread is that of a ratio of sums, and half as large for its root.
ErrorCalibration TwinCheck::finish(double ratio) const {
    const double sources = 0.5 * (1.0 + ratio);
    double twin = 0.0, other = 0.0, strata = 0.0, squares = 0.0;
    for (const Part& p : parts_) twin += p.twin, other += p.other, strata += p.strata;
    const double source = std::max(other - twin, 0.0) / sources, noise = twin + source;
    if (parts_.size() < kFewParts || !(strata > 0.0) || !(noise > 0.0)) return {};
    const double calibration = noise / strata;
    for (const Part& p : parts_) {
        const double part = p.twin + (source > 0.0 ? (p.other - p.twin) / sources : 0.0) - calibration * p.strata;
        squares += part * part;
    }
    return {static_cast<float>(std::clamp(std::sqrt(calibration), kLeastFactor, kMostFactor)),
            static_cast<float>(0.5 * std::sqrt(squares) / noise)};
}

} // namespace ajar
