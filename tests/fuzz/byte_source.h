// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <random>

/// Where a fuzzer's decisions come from: bytes that libFuzzer made up, or a generator with a fixed seed. A byte of
/// zero takes the likelier way everywhere.
class ByteSource {
public:
    explicit ByteSource(uint32_t seed) : random_(seed), endless_(true) {}
    ByteSource(const uint8_t* data, size_t size) : data_(data), left_(size) {}

    /// True once the bytes have run out; zeros follow.
    bool ended() const { return ended_; }

    uint8_t byte() {
        if (endless_) return static_cast<uint8_t>(random_());
        if (left_ == 0) {
            ended_ = true;
            return 0;
        }
        --left_;
        return *data_++;
    }

    /// A number below count, which is 256 at most.
    uint32_t pick(uint32_t count) { return byte() % count; }

    bool chance(double p) {
        const double x = byte() / 256.0;
        return p >= 0.5 ? x < p : x >= 1.0 - p;
    }

    /// Any number; mostly one at which something overflows.
    uint32_t integer() {
        constexpr uint32_t kOdd[] = {0, 1, 2, 3, 4, 16, 255, 0x7fffffffu, 0x80000000u, 0xfffffffeu, 0xffffffffu};
        return chance(0.7) ? kOdd[pick(std::size(kOdd))] : word();
    }

    /// A number of -2..2 and, at times, one that is harder to reckon with.
    float scalar() {
        const float v = any_scalar();
        const float size = std::abs(v);
        if (!(size == 0.0f || (size > 1e-4f && size <= 2.0f))) wild_ = true;
        return v;
    }
    /// True once a number was drawn that is not of the size of things in a room.
    bool wild() const { return wild_; }

private:
    float any_scalar() {
        constexpr float kInfinity = std::numeric_limits<float>::infinity();
        constexpr float kOdd[] = {0.0f,  -0.0f, 1.0f,   -1.0f,     0.5f,       1e-45f,   1e-30f, 1e-6f,
                                  1e30f, 1e6f,  -1e30f, kInfinity, -kInfinity, -3.4e38f, 3.4e38f};
        const uint32_t kind = byte();
        if (kind >= 252) return std::bit_cast<float>(word());
        if (kind >= 248) return std::numeric_limits<float>::quiet_NaN();
        if (kind >= 190) return kOdd[pick(std::size(kOdd))];
        return (byte() + byte() / 256.0f) / 64.0f - 2.0f;
    }

    uint32_t word() {
        uint32_t w = 0;
        for (int i = 0; i < 4; ++i) w = w << 8 | byte();
        return w;
    }

    const uint8_t* data_ = nullptr;
    size_t left_ = 0;
    std::mt19937 random_;
    bool endless_ = false, ended_ = false, wild_ = false;
};
