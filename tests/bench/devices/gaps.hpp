// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>

namespace eti::bench {

struct GapsOptions {
    std::filesystem::path out;
    bool quick = false;  ///< one surface, grip and patient
};

/// Gaps between messages while a hand presses on a wall, on tissue, or levers, on a patient that rests or
/// moves as fast as the server lets it: how far the device is from where it would be without gaps, and for
/// how much of the time it has all of the force, where forces are let go of at once, held for a while, and
/// held on. By the virtual clock. Writes haptics-gaps.csv.
void press_through_gaps(const GapsOptions& options);

}  // namespace eti::bench
