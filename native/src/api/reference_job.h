// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "api/task.h"
#include "reference/reference.h"

namespace ajar {

/// One reference on its own thread.
class ReferenceJob {
public:
    ReferenceJob(std::shared_ptr<const Snapshot> scene, ReferenceSettings settings, uint32_t threads)
        : scene_(std::move(scene)), settings_(std::move(settings)), threads_(threads), task_([this](Progress& p) {
              ThreadPool pool(threads_);
              p.begin_stage(AJAR_STAGE_ACCEL, 0.01f);
              const Tracer tracer(*scene_);
              p.begin_stage(AJAR_STAGE_GATHER, 1.0f);
              result_ = trace_reference(*scene_, tracer, settings_, pool, p);
              if (result_.values.size() < settings_.points) // readers hold room for all of them
                  throw Error(AJAR_ERROR_INPUT,
                              "found only " + std::to_string(result_.values.size()) + " of " +
                                  std::to_string(settings_.points) + " places of lightmapped surfaces in the open",
                              scene_->name);
          }) {}

    Task& task() { return task_; }
    const Snapshot& scene() const { return *scene_; }
    /// Throws AJAR_RUNNING or the failure unless it succeeded.
    const ReferenceResult& result() const {
        task_.require_success();
        return result_;
    }

private:
    std::shared_ptr<const Snapshot> scene_;
    ReferenceSettings settings_;
    uint32_t threads_;
    ReferenceResult result_;
    Task task_; ///< last: it runs while the rest is there
};

} // namespace ajar
