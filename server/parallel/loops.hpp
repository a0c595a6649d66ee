// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>

#include "server/parallel/tsan_annotations.hpp"

namespace eti::parallel {

// Every output has one writer, so that results do not depend on partitioning or thread count.

/// Calls `body(begin, end)` for ranges of at least `grain` indices that cover [0, count).
template <class Body>
void for_ranges(std::size_t count, std::size_t grain, const Body& body) {
    if (count <= grain) {
        body(std::size_t{0}, count);
        return;
    }
    const auto part = [&body](const tbb::blocked_range<std::size_t>& range) {
        tsan_acquire_work();
        body(range.begin(), range.end());
        tsan_release_result();
    };
    tsan_release_work();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), part);
    tsan_acquire_results();
}

/// Calls `body` with each index below `count`.
template <class Index, class Body>
void for_each(Index count, std::size_t grain, const Body& body) {
    for_ranges(static_cast<std::size_t>(count), grain, [&body](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i != end; ++i) {
            body(static_cast<Index>(i));
        }
    });
}

/// Calls both functions concurrently.
template <class First, class Second>
void run_both(const First& first, const Second& second) {
    for_each(2, 1, [&](std::size_t i) { i == 0 ? first() : second(); });
}

}  // namespace eti::parallel
