// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/task.h"

#include <algorithm>
#include <new>

namespace ajar {

Task::Task(std::function<void(Progress&)> work) : work_(std::move(work)) {
    progress_.start();
    thread_ = std::thread([this] { run(); });
}

Task::~Task() {
    cancel();
    if (thread_.joinable()) thread_.join();
}

void Task::run() {
    try {
        work_(progress_);
        progress_.begin_stage(AJAR_STAGE_DONE, 1.0f);
        seconds_ = progress_.elapsed();
        finish(AJAR_OK);
    } catch (const Cancelled&) {
        finish(AJAR_CANCELLED, "the bake was cancelled");
    } catch (const Error& e) {
        finish(e.code(), e.what(), e.culprit());
    } catch (const std::bad_alloc&) {
        finish(AJAR_ERROR_MEMORY, "not enough memory; lower the texel density or the atlas size");
    } catch (const std::exception& e) {
        finish(AJAR_ERROR_INTERNAL, e.what());
    } catch (...) {
        finish(AJAR_ERROR_INTERNAL, "unknown failure");
    }
}

void Task::finish(ajar_result result, const std::string& message, const std::string& culprit) {
    const std::scoped_lock lock(mutex_);
    result_ = result;
    failure_ = {culprit, message};
    done_.notify_all();
}

ajar_result Task::result() const {
    const std::scoped_lock lock(mutex_);
    return result_;
}

Warning Task::failure() const {
    const std::scoped_lock lock(mutex_);
    return failure_;
}

ajar_result Task::wait(double timeout) {
    std::unique_lock lock(mutex_);
    const auto ended = [&] { return result_ != AJAR_RUNNING; };
    if (timeout < 0.0)
        done_.wait(lock, ended);
    else
        done_.wait_for(lock, std::chrono::duration<double>(std::min(timeout, 1e6)), ended);
    return result_;
}

void Task::poll(ajar_progress& out) const {
    out.stage = progress_.stage();
    out.fraction = progress_.fraction();
    out.elapsed = static_cast<float>(progress_.elapsed());
    // Early fractions say little; a guess from them would jump about.
    out.remaining = out.fraction > 0.1f ? out.elapsed * (1.0f - out.fraction) / out.fraction : -1.0f;
    out.result = result();
    out.rays = progress_.rays();
}

void Task::require_success() const {
    const ajar_result r = result();
    if (r == AJAR_RUNNING) throw Error(AJAR_RUNNING, "the bake is still running; wait for it first");
    if (r != AJAR_OK) throw Error(AJAR_ERROR_STATE, "the bake did not finish: " + failure().text, failure().culprit);
}

} // namespace ajar
