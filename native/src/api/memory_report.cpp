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
                 r.shares, r.of_texel, r.ring) +
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

std::vector<std::pair<const char*, uint64_t>> memory_parts(const Snapshot& scene, const JobOutput& o) {
    return {{"scene", scene_bytes(scene)},  {"receivers", receiver_bytes(o.receivers)},
            {"light", light_bytes(o.bake)}, {"spherical_harmonics_layers", bytes(o.bake.sh_rgb, o.pages.sh_rgb)},
            {"terms", term_bytes(o)},       {"pages", page_bytes(o.pages)}};
}

} // namespace ajar
