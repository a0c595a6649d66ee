// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <tbb/task_group.h>

#include <utility>

#include "server/parallel/hand_over.hpp"

namespace eti::parallel {

/// Work that is done beside what its owner does meanwhile.
class Beside {
  public:
    Beside() = default;
    Beside(const Beside&) = delete;
    Beside& operator=(const Beside&) = delete;
    ~Beside() { group_.wait(); }

    /// Starts `work`; what it uses has to last, and stay, until wait().
    template <class Work>
    void run(Work work) {
        give_work();
        group_.run([work = std::move(work)] {
            take_work();
            work();
            give_result();
        });
    }

    void wait() {
        group_.wait();
        take_results();
    }

  private:
    tbb::task_group group_;
};

}  // namespace eti::parallel
