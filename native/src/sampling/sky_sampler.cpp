// SPDX-License-Identifier: GPL-3.0-or-later
#include "sampling/sky_sampler.h"

namespace ajar {

namespace {

/// Index of the entry that u falls into and the position inside it; cdf holds running sums.
uint32_t pick(const float* cdf, uint32_t count, float u, float& inside) {
    const float target = u * cdf[count - 1];
    const auto i =
        static_cast<uint32_t>(std::min<ptrdiff_t>(std::upper_bound(cdf, cdf + count, target) - cdf, count - 1));
    const float before = i > 0 ? cdf[i - 1] : 0.0f;
    inside = std::clamp((target - before) / std::max(cdf[i] - before, 1e-30f), 0.0f, 0x1.fffffep-1f);
    return i;
}

} // namespace

SkySampler::SkySampler(const Sky& sky) : sky_(sky) {
    if (!sky.lit() || !sky.has_image) return;
    const uint32_t w = sky.image.width, h = sky.image.height;
    column_cdf_.resize(size_t{w} * h);
    row_cdf_.resize(h);
    double rows = 0.0;
    for (uint32_t y = 0; y < h; ++y) {
        double sum = 0.0;
        for (uint32_t x = 0; x < w; ++x) {
            sum += std::max(0.0f, luminance(sky.color * Vec3(sky.image.texel(x, y)))) * texel_solid_angle(y);
            column_cdf_[size_t{y} * w + x] = static_cast<float>(sum);
        }
        rows += sum;
        row_cdf_[y] = static_cast<float>(rows);
    }
    total_ = static_cast<float>(rows);
}

float SkySampler::texel_solid_angle(uint32_t y) const {
    const auto h = static_cast<float>(sky_.image.height);
    const float low = (static_cast<float>(y) / h - 0.5f) * kPi, high = (static_cast<float>(y + 1) / h - 0.5f) * kPi;
    return (std::sin(high) - std::sin(low)) * 2.0f * kPi / static_cast<float>(sky_.image.width);
}

SkySample SkySampler::sample(const Vec2& u) const {
    if (!(total_ > 0.0f)) return {};
    const uint32_t w = sky_.image.width, h = sky_.image.height;
    float fx, fy;
    const uint32_t y = pick(row_cdf_.data(), h, u.y, fy);
    const uint32_t x = pick(&column_cdf_[size_t{y} * w], w, u.x, fx);
    // Uniform in solid angle inside the texel: linear in the sine of the latitude.
    const float low = std::sin((static_cast<float>(y) / static_cast<float>(h) - 0.5f) * kPi);
    const float high = std::sin((static_cast<float>(y + 1) / static_cast<float>(h) - 0.5f) * kPi);
    const float z = std::clamp(low + (high - low) * fy, -1.0f, 1.0f);
    const float phi = (0.5f - (static_cast<float>(x) + fx) / static_cast<float>(w)) * 2.0f * kPi;
    const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const Vec3 radiance = sky_.color * Vec3(sky_.image.texel(x, y));
    return {{r * std::cos(phi), r * std::sin(phi), z}, radiance, luminance(radiance) / total_};
}

float SkySampler::pdf(const Vec3& w) const {
    return total_ > 0.0f ? std::max(0.0f, luminance(sky_.radiance(w))) / total_ : 0.0f;
}

} // namespace ajar
