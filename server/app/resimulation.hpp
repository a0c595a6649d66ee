// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/app/options.hpp"

namespace eti::app {

/// Runs the inputs of a recorded session again and compares every step with the record, or, with settings,
/// says what the same hands would have come to on another patient. Returns the program's exit status: 0 if
/// all steps came out as recorded, or something was set.
[[nodiscard]] int resimulate(const Options& options);

}  // namespace eti::app
