// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstddef>

namespace eti::test {

/// Does `work` with as many threads, also where the machine has fewer processors: the usual arena has no room
/// for more than these, whatever is allowed.
template <class Work>
auto with_threads(std::size_t threads, const Work& work) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    tbb::task_arena arena(static_cast<int>(threads));
    return arena.execute(work);
}

}  // namespace eti::test
