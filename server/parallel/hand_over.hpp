// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>

#include <cstddef>
#endif

namespace eti::parallel {

// oneTBB's library is not compiled for the thread sanitizer, which therefore cannot see that one thread waits
// for another there. These tell it, and are nothing in any other build. One mark for all loops: a loop's body
// would have to read where its own lies before the sanitizer knows that it may.

#ifdef __SANITIZE_THREAD__

inline std::byte work{}, result{};

/// Before others are given work: what this thread has written they may use.
inline void give_work() {
    __tsan_release(&work);
}

/// First thing in that work.
inline void take_work() {
    __tsan_acquire(&work);
}

/// Last thing in it.
inline void give_result() {
    __tsan_release(&result);
}

/// After it was waited for: what the others have written this thread may use.
inline void take_results() {
    __tsan_acquire(&result);
}

#else

inline void give_work() {}
inline void take_work() {}
inline void give_result() {}
inline void take_results() {}

#endif

}  // namespace eti::parallel
