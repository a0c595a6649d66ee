// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <cstdint>

namespace eti::view {

/// A number that no shape of this process had before. A scene and its copy that go on apart then never have
/// the same number for different shapes, and whoever holds one of them elsewhere can tell.
[[nodiscard]] inline std::uint64_t next_revision() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
}

}  // namespace eti::view
