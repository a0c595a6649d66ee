// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>

namespace eti::devices {

/// Allocations that this thread has made so far.
[[nodiscard]] std::uint64_t allocations();

}  // namespace eti::devices
