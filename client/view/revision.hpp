// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <cstdint>

namespace eti::view {

/// Returns a number unique in this process. A scene and its diverging copy never share a revision for
/// different shapes, so that caches can detect changes.
[[nodiscard]] inline std::uint64_t next_revision() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
}

}  // namespace eti::view
