// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/app/options.hpp"

namespace eti::app {

/// Publishes a recorded session as if it were live. Returns the program's exit status.
[[nodiscard]] int replay(const Options& options);

}  // namespace eti::app
