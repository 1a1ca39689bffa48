// SPDX-License-Identifier: GPL-3.0-or-later
#include "pass/missed_light.h"

namespace ajar {

namespace {

constexpr float kRuledByOne =
    0.5f;                          ///< relative standard error from which on fewer than four rays are most of the light
constexpr float kMostRuled = 0.3f; ///< of a tile's receivers: with more, the light is noisy, not rare
constexpr float kMostMissed = 0.999f;

/// What the receivers of a bake missed.
struct MissedLight {
    double squares = 0.0;             ///< sum of squared relative errors
    double rare = 0.0;                ///< of those, in tiles where light was missed
    std::vector<float> missed, error; ///< per receiver, W/m^2
    double met = 0.0;                 ///< receivers that met it
};

/// Mean light of some receivers.
struct TileMean {
    double sum = 0.0;
    uint32_t count = 0;

    void add(float level) { sum += level, ++count; }
    double mean() const { return count > 0 ? sum / count : 0.0; }
};

/// Light that a tile's receivers lack.
struct MissedShare {
    float share = 0.0f;  ///< of its mean light
    float chance = 1.0f; ///< of a receiver to have met it
};

MissedShare missed_share(const TileMean& all, const TileMean& quiet) {
    const uint32_t ruled = all.count - quiet.count;
    const float chance = static_cast<float>(ruled) / static_cast<float>(std::max(all.count, 1u));
    if (ruled == 0 || chance > kMostRuled || !(all.mean() > 0.0)) return {};
    return {std::clamp(static_cast<float>(1.0 - quiet.mean() / all.mean()), 0.0f, kMostMissed), chance};
}

/// levels: luminance per receiver, W/m^2; errors: its standard errors, which get what was missed.
MissedLight add_missed_light(const LightmapReceivers& receivers, const std::vector<float>& inside,
                             const std::vector<float>& levels, std::vector<float>& errors) {
    MissedLight out{0.0, 0.0, std::vector<float>(levels.size(), 0.0f), std::vector<float>(levels.size(), 0.0f), 0.0};
    const float dark = dark_level(levels) + 1e-30f;
    const auto counts = [&](uint32_t r) { return receivers.ring[r] == 0 && inside[r] <= kInsideShare; };
    const auto level = [&](uint32_t r) { return std::max(levels[r], 0.0f); };
    const auto is_quiet = [&](uint32_t r) { return errors[r] <= kRuledByOne * (level(r) + dark); };
    for (const Tile& tile : receivers.tiles) {
        TileMean all, quiet;
        for (uint32_t r = tile.first; r < tile.first + tile.count; ++r) {
            if (!counts(r)) continue;
            all.add(levels[r]);
            if (is_quiet(r)) quiet.add(levels[r]);
        }
        const MissedShare missed = missed_share(all, quiet);
        for (uint32_t r = tile.first; r < tile.first + tile.count; ++r) {
            if (!counts(r)) continue;
            const bool met = !is_quiet(r);
            if (!met) out.missed[r] = level(r) * missed.share / (1.0f - missed.share);
            const double relative = std::hypot(errors[r], out.missed[r]) / (level(r) + out.missed[r] + dark),
                         square = std::min(relative * relative, 1.0);
            out.squares += square;
            if (missed.share > 0.0f) out.rare += square, out.met += met ? 1.0 : 0.0;
            out.error[r] = out.missed[r] / std::sqrt(missed.chance);
            errors[r] = std::hypot(errors[r], out.error[r]);
        }
    }
    return out;
}

} // namespace

void state_missed_light(const LightmapReceivers& receivers, BakeResult& result) {
    std::vector<float> levels;
    for (const Vec3& e : result.irradiance) levels.push_back(luminance(e));
    MissedLight found = add_missed_light(receivers, result.inside, levels, result.standard_error);
    if (!result.total.empty()) found = add_missed_light(receivers, result.inside, result.total, result.total_error);
    if (!(found.met > 0.0)) return;
    result.missed = std::move(found.missed), result.missed_error = std::move(found.error);
    result.calibration.spread =
        std::max(result.calibration.spread, static_cast<float>(found.rare / found.squares / std::sqrt(found.met)));
}

} // namespace ajar
