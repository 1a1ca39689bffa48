// SPDX-License-Identifier: Apache-2.0
#version 430
// What ajar_runtime_update does, on a graphics card: base plus weighted terms, packed, one receiver
// per invocation. The host fills buffers 0..2 once from ajar_runtime_get_buffers and the page words
// from the package's DDS files, and for each update 3 and 4 from ajar_runtime_plan_update, then
// dispatches group_count groups. Formats: terms_format.h; arithmetic: texel.h, step by step.

layout(local_size_x = 64) in; // AJAR_RUNTIME_GROUP_SIZE

layout(std430, binding = 0) readonly buffer Dispatches { uint dispatches[]; };
layout(std430, binding = 1) readonly buffer Palette { uint palettes[]; };
layout(std430, binding = 2) readonly buffer Data { uint data[]; };
layout(std430, binding = 3) readonly buffer Groups { uvec2 groups[]; };          // dispatch, first receiver
layout(std430, binding = 4) readonly buffer Weights { vec4 weights[]; };         // of terms
layout(std430, binding = 5) readonly buffer Pages { uvec2 pages[]; };            // first word, width
layout(std430, binding = 6) buffer Irradiance { uint page_irradiance[]; };       // R11G11B10F, all pages
layout(std430, binding = 7) buffer Direction { uint page_direction[]; };         // RGBA8

const uint kU = 0u, kQ = 1u, kV8 = 2u, kB = 4u;
const uint kBlock = 16u; // receivers of a block of class B

struct Dispatch {
    uint kind, k, words, page, receivers, entries, palette, address, base, payload, index, counts, starts;
};

Dispatch read_dispatch(uint number) {
    uint w = 16u * number;
    return Dispatch(dispatches[w], dispatches[w + 1u], dispatches[w + 2u], dispatches[w + 3u], dispatches[w + 4u],
                    dispatches[w + 5u], dispatches[w + 6u], dispatches[w + 8u], dispatches[w + 9u],
                    dispatches[w + 10u], dispatches[w + 11u], dispatches[w + 12u], dispatches[w + 13u]);
}

uint data_byte(uint word, uint number) { return (data[word + (number >> 2)] >> (8u * (number & 3u))) & 0xffu; }
uint data_short(uint word, uint number) { return (data[word + (number >> 1)] >> (16u * (number & 1u))) & 0xffffu; }
uint palette_term(uint number) { return (palettes[number >> 1] >> (16u * (number & 1u))) & 0xffffu; }

// ---- texel.h

struct State {
    vec3 e;
    float a, dx, dy;
};

float luminance(vec3 c) {
    precise float sum = 0.2126 * c.r + 0.7152 * c.g;
    precise float all = sum + 0.0722 * c.b;
    return all;
}

float unpack_small(uint p, int mantissa) {
    float normal = uintBitsToFloat((p << (23 - mantissa)) + (112u << 23));
    float step_size = mantissa == 6 ? 1.0 / 1048576.0 : mantissa == 5 ? 1.0 / 524288.0 : 1.0 / 16777216.0;
    return (p >> mantissa) == 0u ? float(int(p)) * step_size : normal;
}

uint pack_small(float v, int mantissa, float largest) {
    const float least_normal = 1.0 / 16384.0;
    float limited = v < largest ? (v > 0.0 ? v : 0.0) : largest;
    uint shift = uint(23 - mantissa);
    uint bits = floatBitsToUint(limited) - (112u << 23);
    uint normal = (bits + (1u << (shift - 1u)) - 1u + ((bits >> shift) & 1u)) >> shift;
    precise float steps = (limited < least_normal ? limited : 0.0) * (mantissa == 6 ? 1048576.0 : 524288.0);
    precise float rounded = steps + 0.5;
    return limited < least_normal ? uint(int(rounded)) : normal;
}

vec3 unpack_irradiance(uint p) {
    return vec3(unpack_small(p & 0x7ffu, 6), unpack_small((p >> 11) & 0x7ffu, 6), unpack_small(p >> 22, 5));
}

uint pack_irradiance(vec3 e) {
    return pack_small(e.r, 6, 65024.0) | (pack_small(e.g, 6, 65024.0) << 11) | (pack_small(e.b, 5, 64512.0) << 22);
}

float unpack_half(uint p) {
    float v = unpack_small(p & 0x7fffu, 10);
    return (p & 0x8000u) != 0u ? -v : v;
}

float channel(uint word, int shift) {
    precise float v = float(int((word >> shift) & 0xffu)) / 255.0;
    return v;
}

State make_linear(vec3 e, uint word) {
    precise float r = channel(word, 24);
    precise float z = channel(word, 16) * 2.0 - 1.0;
    float height = z > 0.1 ? z : 0.1;
    precise float total = luminance(e);
    precise float highlight = (1.0 - r) * total;
    precise float x = (channel(word, 0) * 2.0 - 1.0) / height;
    precise float y = (channel(word, 8) * 2.0 - 1.0) / height;
    precise float a = r * total;
    precise float dx = highlight * x;
    precise float dy = highlight * y;
    return State(e, a, dx, dy);
}

State plus(State s, State t) {
    precise vec3 e = s.e + t.e;
    precise float a = s.a + t.a;
    precise float dx = s.dx + t.dx;
    precise float dy = s.dy + t.dy;
    return State(e, a, dx, dy);
}

uint unorm8(float v) {
    precise float scaled = v * 255.0 + 0.5;
    return uint(int(scaled));
}

float limit(float v, float low, float high) { return v < high ? (v > low ? v : low) : high; }

uvec2 pack_texel(State s) {
    vec3 e = vec3(s.e.r > 0.0 ? s.e.r : 0.0, s.e.g > 0.0 ? s.e.g : 0.0, s.e.b > 0.0 ? s.e.b : 0.0);
    precise float total = luminance(e);
    precise float ambient = limit(s.a, 0.0, total);
    precise float highlight = total - ambient;
    precise float ratio = ambient / (total > 0.0 ? total : 1.0);
    bool has_highlight = total > 0.0 && ratio < 1.0 - 0.5 / 255.0;
    if (!has_highlight) return uvec2(pack_irradiance(e), 0xff8080u | (unorm8(total > 0.0 ? ratio : 1.0) << 24));
    precise float sx = limit(s.dx / highlight, -1e15, 1e15);
    precise float sy = limit(s.dy / highlight, -1e15, 1e15);
    precise float slope2 = sx * sx + sy * sy;
    precise float flatten = slope2 > 24.0 ? sqrt(24.0 / slope2) : 1.0;
    precise float x = sx * flatten;
    precise float y = sy * flatten;
    precise float length2 = x * x + y * y;
    precise float z = 1.0 / sqrt(1.0 + length2);
    precise float px = x * z * 0.5 + 0.5;
    precise float py = y * z * 0.5 + 0.5;
    precise float pz = z * 0.5 + 0.5;
    return uvec2(pack_irradiance(e), unorm8(px) | (unorm8(py) << 8) | (unorm8(pz) << 16) | (unorm8(ratio) << 24));
}

// ---- a receiver's entries

/// First entry and number of entries of a receiver whose entries lie one after the other.
uvec2 list_of(Dispatch d, uint t) {
    uint least = d.kind == kV8 ? 5u : 9u, bits = d.kind == kV8 ? 2u : 3u, batch = d.kind == kV8 ? 16u : 8u;
    uint number = t / batch, place = t % batch, bit = bits * batch * number, word = bit >> 5, shift = bit & 31u;
    uint fields = data[d.counts + word] >> shift;
    if (shift + bits * batch > 32u) fields |= data[d.counts + word + 1u] << (32u - shift);
    uint first = data_short(d.starts, number);
    uint mask = (1u << bits) - 1u;
    for (uint i = 0u; i < place; ++i) first += least + ((fields >> (bits * i)) & mask);
    return uvec2(first, least + ((fields >> (bits * place)) & mask));
}

vec3 entry_irradiance(Dispatch d, uint entry) {
    uint first = data[d.payload + entry];
    if (d.words == 2u) return unpack_irradiance(first);
    return vec3(unpack_half(first & 0xffffu), unpack_half(first >> 16),
                unpack_half(data[d.payload + d.entries + entry] & 0xffffu));
}

/// A receiver's light so far, and whether any term of it is on.
struct Sum {
    State state;
    bool on;
};

void add_entry(Dispatch d, uint entry, uint place, inout Sum sum) {
    vec3 weight = weights[palette_term(d.palette + place)].rgb;
    if (weight == vec3(0.0)) return;
    sum.on = true;
    precise vec3 light = entry_irradiance(d, entry) * weight;
    sum.state = plus(sum.state, make_linear(light, data[d.payload + (d.words - 1u) * d.entries + entry]));
}

/// Classes U, Q, V8 and V16.
void add_list(Dispatch d, uint t, inout Sum sum) {
    bool strided = d.kind == kU || d.kind == kQ;
    uvec2 list = strided ? uvec2(t, d.k) : list_of(d, t);
    for (uint slot = 0u; slot < list.y; ++slot) {
        uint entry = list.x + slot * (strided ? d.receivers : 1u);
        add_entry(d, entry, d.kind == kU ? slot : data_byte(d.index, entry), sum);
    }
}

/// Class B: the slots of the receiver's block.
void add_block(Dispatch d, uint t, inout Sum sum) {
    uint start = d.starts + 2u * (t / kBlock), lane = t % kBlock;
    uint entry = data[start + 1u], end = data[start + 2u];
    for (uint slot = data[start]; slot < end; ++slot) {
        uint word = data[d.index + slot], mask = word >> 16;
        if (((mask >> lane) & 1u) != 0u)
            add_entry(d, entry + uint(bitCount(mask & ((1u << lane) - 1u))), word & 0xffffu, sum);
        entry += uint(bitCount(mask));
    }
}

void main() {
    uvec2 group = groups[gl_WorkGroupID.x];
    Dispatch d = read_dispatch(group.x);
    uint t = group.y + gl_LocalInvocationID.x;
    if (t >= d.receivers) return;
    uint base_irradiance = data[d.base + t], base_direction = data[d.base + d.receivers + t];
    Sum sum = Sum(make_linear(unpack_irradiance(base_irradiance), base_direction), false);
    if (d.kind == kB)
        add_block(d, t, sum);
    else
        add_list(d, t, sum);
    uvec2 texel_words = sum.on ? pack_texel(sum.state) : uvec2(base_irradiance, base_direction);
    uint address = data[d.address + t];
    uint texel = pages[d.page].x + (address >> 16) * pages[d.page].y + (address & 0xffffu);
    page_irradiance[texel] = texel_words.x;
    page_direction[texel] = texel_words.y;
}
