// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace ajar {

inline constexpr uint32_t kLanes = 8; ///< rays per packet

/// A number per ray of a packet, computed together (vector extension of GCC and Clang).
typedef float Lanes __attribute__((vector_size(4 * kLanes), may_alias));

/// Eight floats in memory, 32-byte aligned.
inline Lanes& lanes(float* p) { return *reinterpret_cast<Lanes*>(p); }
inline const Lanes& lanes(const float* p) { return *reinterpret_cast<const Lanes*>(p); }

} // namespace ajar
