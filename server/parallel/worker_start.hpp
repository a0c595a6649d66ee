// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <tbb/task_scheduler_observer.h>

#include <atomic>
#include <cstdint>
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
        // By number: a later observer may lie at the same address.
        thread_local std::uint64_t started_by = 0;
        if (is_worker && started_by != number_) {
            started_by = number_;
            tsan_acquire_work();
            start_();
        }
    }

    std::function<void()> start_;
    static inline std::atomic<std::uint64_t> made_{0};
    const std::uint64_t number_ = ++made_;
};

}  // namespace eti::parallel
