// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/tile_aims.h"

#include "base/owen_sobol.h"

namespace ajar {

namespace {

constexpr uint32_t kProbes = 16;         ///< rays that look for a box
constexpr float kLargeShare = 1.0f / 16; ///< of the hemisphere's rays: a box that more of them meet needs no aim

} // namespace

TileAims::Found TileAims::probe(const Tracer& tracer, const AimBox& box, const Look& look, uint32_t seed) const {
    Found found;
    uint32_t seen = 0, far = 0;
    for (uint32_t i = 0; i < kProbes; ++i) {
        const uint32_t h = hash_combine(hash_combine(seed, box.element), i), local = h % tile_.count;
        const uint32_t position = i % receivers_.positions_per_texel;
        const Vec3& p = origin(local, position);
        const AimBox::View view = box.view_from(p);
        if (!(view.solid_angle > 0.0f)) continue;
        const Vec3 w = view.sample(owen_sobol(i, h));
        const float cosine = glm::dot(w, receivers_.frame[tile_.first + local].z);
        if (!(cosine > 0.0f) || !receivers_.is_above(tile_.first + local, position, w)) continue;
        ++found.rays;
        const Ray ray{p, w};
        const Hit hit = tracer.intersect(ray, kMaskGather);
        if (hit.triangle != kMiss && hit.t < box.distance(p, w) * 0.999f) continue;
        ++seen;
        far += view.solid_angle * cosine * kInvPi < kLargeShare;
        const Arrival arrival = look(ray, hit);
        const float scale = view.solid_angle * cosine / static_cast<float>(kProbes);
        found.light += scale * arrival.light, found.worth += scale * arrival.worth;
    }
    found.rarely_met = 4 * far >= std::max(seen, 1u);
    return found;
}

uint64_t TileAims::add(const Tracer& tracer, const AimBox& box, const Look& look, uint32_t rays, float least,
                       uint32_t seed) {
    if (rays == 0) return 0;
    const Found found = probe(tracer, box, look, seed);
    if (!(found.worth > 1.0f) || !(found.light >= least) || !found.rarely_met) return found.rays;
    add(box, rays);
    return found.rays;
}

void TileAims::add(const AimBox& box, uint32_t rays) {
    aims_.push_back(
        {box, rays, std::vector<uint32_t>(size_t{tile_.count} * receivers_.positions_per_texel, kNotYet), {}});
}

const AimBox::View& TileAims::view(const Aim& aim, uint32_t local, uint32_t position) const {
    uint32_t& number = aim.number[size_t{local} * receivers_.positions_per_texel + position];
    if (number == kNotYet) {
        number = static_cast<uint32_t>(aim.views.size());
        aim.views.push_back(aim.box.view_from(origin(local, position)));
    }
    return aim.views[number];
}

float TileAims::density(uint32_t local, uint32_t position, const Vec3& w) const {
    float sum = 0.0f;
    for (const Aim& a : aims_) {
        if (!std::isfinite(a.box.distance(origin(local, position), w))) continue;
        if (const float omega = view(a, local, position).solid_angle; omega > 0.0f)
            sum += static_cast<float>(a.rays) / omega;
    }
    return sum;
}

bool TileAims::sample(uint32_t aim, uint32_t local, uint32_t position, const Vec2& u, Vec3& w) const {
    const AimBox::View& from = view(aims_[aim], local, position);
    if (!(from.solid_angle > 0.0f)) return false;
    w = from.sample(u);
    return true;
}

} // namespace ajar
