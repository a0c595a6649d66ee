// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>

namespace eti::bench {

struct GapsOptions {
    std::filesystem::path out;
    bool quick = false;  ///< one surface, grip and patient
};

/// Gaps between messages while a hand presses on a wall, presses on tissue, or levers. The patient rests or
/// moves as fast as the server allows. Measures the device's deviation from its path without gaps, and the
/// share of the time with full force, where forces are released at once, held for a while, or held on. By the
/// virtual clock. Writes haptics-gaps.csv.
void press_through_gaps(const GapsOptions& options);

}  // namespace eti::bench
