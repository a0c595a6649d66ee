// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>

#include <cstddef>
#endif

namespace eti::parallel {

// oneTBB's library is not built with the thread sanitizer, which therefore does not see its synchronization.
// These functions annotate it, and do nothing in other builds. All loops share one mark: with a mark per
// loop, the loop's body would have to read the mark's address before the sanitizer knows that the read is
// ordered.

#ifdef __SANITIZE_THREAD__

inline std::byte work{}, result{};

/// Call before work is handed to other threads: publishes this thread's writes.
inline void tsan_release_work() {
    __tsan_release(&work);
}

/// Call first in that work.
inline void tsan_acquire_work() {
    __tsan_acquire(&work);
}

/// Call last in that work.
inline void tsan_release_result() {
    __tsan_release(&result);
}

/// Call after waiting for it: acquires the other threads' writes.
inline void tsan_acquire_results() {
    __tsan_acquire(&result);
}

#else

inline void tsan_release_work() {}
inline void tsan_acquire_work() {}
inline void tsan_release_result() {}
inline void tsan_acquire_results() {}

#endif

}  // namespace eti::parallel
