// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::test {

/// Number of calls of operator new by this test program.
[[nodiscard]] long allocations();

/// The same for the calling thread only, where other threads run at the same time.
[[nodiscard]] long allocations_here();

}  // namespace eti::test
