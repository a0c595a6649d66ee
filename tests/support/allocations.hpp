// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::test {

/// How often this test program has called operator new so far.
[[nodiscard]] long allocations();

/// The same of the calling thread alone, where others go on beside it.
[[nodiscard]] long allocations_here();

}  // namespace eti::test
