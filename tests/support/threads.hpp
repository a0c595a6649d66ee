// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstddef>

namespace eti::test {

/// Runs `work` with that many threads, even on a machine with fewer processors: the default arena never has
/// more slots than processors, whatever the limit.
template <class Work>
auto with_threads(std::size_t threads, const Work& work) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    tbb::task_arena arena(static_cast<int>(threads));
    return arena.execute(work);
}

}  // namespace eti::test
