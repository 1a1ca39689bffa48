// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "base/progress.h"

namespace ajar {

/// Work on a thread of its own that is polled, waited for and cancelled from outside; keeps its
/// result and failure.
class Task {
public:
    /// Runs work(progress) at once. What it throws becomes the result.
    explicit Task(std::function<void(Progress&)> work);
    /// Cancels and waits.
    ~Task();

    void poll(ajar_progress& out) const;
    void cancel() { progress_.request_cancel(); }
    /// Result, or AJAR_RUNNING when timeout seconds (negative: forever) pass first.
    ajar_result wait(double timeout);
    ajar_result result() const;
    Warning failure() const;
    /// Throws AJAR_RUNNING or the failure unless it succeeded.
    void require_success() const;

    const Progress& progress() const { return progress_; }
    double seconds() const { return seconds_; }

private:
    void run();
    void finish(ajar_result result, const std::string& message = {}, const std::string& culprit = {});

    std::function<void(Progress&)> work_;
    Progress progress_;
    mutable std::mutex mutex_;
    std::condition_variable done_;
    ajar_result result_ = AJAR_RUNNING;
    Warning failure_;
    double seconds_ = 0.0;
    std::thread thread_;
};

} // namespace ajar
