// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <tbb/task_group.h>

#include <utility>

#include "server/parallel/tsan_annotations.hpp"

namespace eti::parallel {

/// Runs work on TBB's threads while the owner continues.
class BackgroundTask {
  public:
    BackgroundTask() = default;
    BackgroundTask(const BackgroundTask&) = delete;
    BackgroundTask& operator=(const BackgroundTask&) = delete;
    ~BackgroundTask() { group_.wait(); }

    /// Starts `work`. Data that it uses must stay valid and unchanged until wait() returns.
    template <class Work>
    void run(Work work) {
        tsan_release_work();
        group_.run([work = std::move(work)] {
            tsan_acquire_work();
            work();
            tsan_release_result();
        });
    }

    void wait() {
        group_.wait();
        tsan_acquire_results();
    }

  private:
    tbb::task_group group_;
};

}  // namespace eti::parallel
