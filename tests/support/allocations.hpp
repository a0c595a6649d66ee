// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::test {

/// How often this test program has called operator new so far.
[[nodiscard]] long allocations();

}  // namespace eti::test
