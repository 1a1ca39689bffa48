// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/memory_report.h"

namespace ajar {

namespace {

/// Bytes of vectors of plain values.
template <class... T>
uint64_t bytes(const std::vector<T>&... v) {
    return (uint64_t{0} + ... + (v.capacity() * sizeof(T)));
}

uint64_t scene_bytes(const Snapshot& s) {
    uint64_t sum = bytes(s.positions, s.triangles);
    for (const Texture& t : s.textures) sum += bytes(t.bytes, t.floats);
    return sum;
}

uint64_t receiver_bytes(const LightmapReceivers& r) {
    return bytes(r.tiles, r.texel, r.triangle, r.frame, r.positions, r.albedo, r.texel_size, r.full, r.whole, r.cut,
                 r.shares, r.of_texel, r.coarse_from, r.ring) +
           bytes(r.moved_row, r.moved);
}

uint64_t light_bytes(const BakeResult& b) {
    uint64_t sum = bytes(b.irradiance, b.sh, b.standard_error, b.samples, b.inside, b.source);
    for (const auto& bounce : b.bounces) sum += bytes(bounce);
    return sum;
}

uint64_t term_bytes(const JobOutput& o) {
    const TermResult& t = o.bake.terms;
    uint64_t sum = bytes(t.terms, t.first, t.light, t.discarded) + bytes(o.bake.total, o.bake.total_error);
    for (const BakedTerm& b : o.pages.terms) sum += bytes(b.elements, b.texel, b.irradiance, b.packed_direction);
    return sum;
}

uint64_t page_bytes(const BakedPages& p) {
    uint64_t sum =
        bytes(p.irradiance, p.albedo, p.standard_error, p.samples, p.validity, p.packed_irradiance, p.packed_direction);
    for (const auto& bounce : p.bounces) sum += bytes(bounce);
    return sum;
}

} // namespace

MemoryParts memory_parts(const Snapshot& scene, const JobOutput& o) {
    return {{"scene", scene_bytes(scene)},  {"receivers", receiver_bytes(o.receivers)},
            {"light", light_bytes(o.bake)}, {"spherical_harmonics_layers", bytes(o.bake.sh_rgb, o.pages.sh_rgb)},
            {"terms", term_bytes(o)},       {"pages", page_bytes(o.pages)}};
}

MemoryParts predicted_memory_parts(const Snapshot& scene, const JobOutput& o, const ajar_settings& settings) {
    constexpr uint64_t kSh = kShCount * sizeof(float), kShRgb = 3 * kSh;
    // Irradiance, source and spherical harmonics; standard error, samples and share inside.
    constexpr uint64_t kReceiver = 2 * sizeof(Vec3) + kSh + 3 * sizeof(float);
    // Irradiance and albedo; standard error, samples, validity, packed irradiance and direction.
    constexpr uint64_t kTexel = 2 * sizeof(Vec3) + 5 * 4;
    constexpr uint64_t kLight = sizeof(TermLight) + sizeof(uint32_t) + sizeof(Vec3) + sizeof(uint32_t);
    const uint64_t receivers = o.receivers.count(), texels = scene.texel_count();
    const uint64_t sh = settings.keep_sh != 0 ? kShRgb * (receivers + texels) : 0;
    const uint64_t bounces = settings.keep_bounces != 0 ? (settings.bounces + 1) * sizeof(Vec3) : 0;
    return {{"scene", scene_bytes(scene)},
            {"receivers", receiver_bytes(o.receivers)},
            {"light", receivers * (kReceiver + bounces)},
            {"spherical_harmonics_layers", sh},
            {"terms", static_cast<uint64_t>(o.bake.trial.lights * kLight)},
            {"pages", texels * (kTexel + bounces)}};
}

} // namespace ajar
