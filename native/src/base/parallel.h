// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "base/progress.h"

namespace ajar {

/// The threads of one job. Work is split by index only, so results never depend on their number.
class ThreadPool {
public:
    /// threads = 0 takes every core of the machine.
    explicit ThreadPool(uint32_t threads);
    ~ThreadPool();

    uint32_t size() const { return size_; }
    /// Calls body(i) for i in [0, count), checks for cancel between calls and, where report is
    /// set, updates the stage's fraction. Throws Cancelled, or what body threw first.
    void for_each(size_t count, Progress& progress, const std::function<void(size_t)>& body, bool report = true);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
    uint32_t size_;
};

} // namespace ajar
