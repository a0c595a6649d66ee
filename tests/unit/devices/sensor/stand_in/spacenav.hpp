// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>

namespace eti::stand_in {

/// Controls of the libspnav stand-in for a test, returned by its function stand_in_spacenav().
struct SpacenavState {
    std::atomic<bool> daemon{true};  ///< spacenavd runs
    std::atomic<int> opened{0};
    /// Sends a motion event, a button event (type 2) or a hot-plug event (SPNAV_EVENT_DEV); false when no
    /// client is connected.
    bool (*send)(int type, const int (&values)[6], unsigned int period_ms) = nullptr;
    void (*hang_up)() = nullptr;  ///< the daemon dies
};

}  // namespace eti::stand_in
