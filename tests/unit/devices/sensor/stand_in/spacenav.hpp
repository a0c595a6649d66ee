// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>

namespace eti::stand_in {

/// What a test may do to the libspnav stand-in, by its function stand_in_spacenav().
struct SpacenavState {
    std::atomic<bool> daemon{true};  ///< spacenavd runs
    std::atomic<int> opened{0};
    /// Sends a motion event, a button's (type 2) or one of coming and going (SPNAV_EVENT_DEV); false when
    /// nobody listens.
    bool (*send)(int type, const int (&values)[6], unsigned int period_ms) = nullptr;
    void (*hang_up)() = nullptr;  ///< the daemon dies
};

}  // namespace eti::stand_in
