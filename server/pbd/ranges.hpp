// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>

namespace eti::pbd {

// Every output has one writer, so that neither the cuts nor the number of threads change a bit.

/// Calls `body` with the first and one past the last of ranges that are cut no finer than `grain`.
template <class Body>
void for_ranges(std::size_t count, std::size_t grain, const Body& body) {
    if (count <= grain) {
        body(std::size_t{0}, count);
        return;
    }
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, grain),
        [&](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); });
}

/// Calls `body` with each index.
template <class Body>
void for_each(std::size_t count, std::size_t grain, const Body& body) {
    for_ranges(count, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i != end; ++i) {
            body(i);
        }
    });
}

}  // namespace eti::pbd
