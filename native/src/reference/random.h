// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace ajar {

/// PCG32 (O'Neill 2014): the reference draws plain independent numbers, no sequence of the baker's.
class Pcg {
public:
    Pcg(uint64_t seed, uint64_t stream) : increment_(stream << 1 | 1) {
        next();
        state_ += seed;
        next();
    }
    uint32_t next() {
        const uint64_t old = state_;
        state_ = old * 6364136223846793005ull + increment_;
        const auto shifted = static_cast<uint32_t>(((old >> 18) ^ old) >> 27);
        const auto turn = static_cast<uint32_t>(old >> 59);
        return shifted >> turn | shifted << (-turn & 31);
    }
    /// In [0, 1).
    float uniform() { return static_cast<float>(next() >> 8) * 0x1p-24f; }

private:
    uint64_t state_ = 0, increment_;
};

} // namespace ajar
