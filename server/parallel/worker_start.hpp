// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <tbb/task_scheduler_observer.h>

#include <functional>
#include <utility>

#include "server/parallel/tsan_annotations.hpp"

namespace eti::parallel {

/// Calls `start` once in every worker thread of the constructing thread's arena, before the worker's next
/// task.
class WorkerStart : private tbb::task_scheduler_observer {
  public:
    explicit WorkerStart(std::function<void()> start) : start_(std::move(start)) {
        tsan_release_work();
        observe(true);
    }
    ~WorkerStart() override { observe(false); }
    WorkerStart(const WorkerStart&) = delete;
    WorkerStart& operator=(const WorkerStart&) = delete;

  private:
    void on_scheduler_entry(bool is_worker) override {
        thread_local const void* started_by = nullptr;
        if (is_worker && started_by != this) {
            started_by = this;
            tsan_acquire_work();
            start_();
        }
    }

    std::function<void()> start_;
};

}  // namespace eti::parallel
