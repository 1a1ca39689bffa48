// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>

namespace bench {

/// What a replay traced and how many rays of it met something.
struct RayCount {
    uint64_t rays = 0, hits = 0;
};

/// Every ray that the engine hands to Embree between start() and stop(), to be traced again by
/// Embree alone: the ceiling of what a gather can reach. The linker sends the engine's calls here
/// (-Wl,--wrap). One recorder records at a time; on one thread only.
class EmbreeRecorder {
public:
    EmbreeRecorder();
    ~EmbreeRecorder();
    EmbreeRecorder(EmbreeRecorder&&) noexcept;

    void start();
    void stop();
    /// Rays and hits as recorded.
    RayCount recorded() const;
    /// Traces the rays again, packets as packets and single rays as single rays.
    RayCount replay() const;

    struct Calls;

private:
    std::unique_ptr<Calls> calls_;
};

} // namespace bench
