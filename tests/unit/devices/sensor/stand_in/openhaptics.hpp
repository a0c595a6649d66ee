// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <atomic>

namespace eti::stand_in {

/// Controls of the OpenHaptics stand-in for a test, returned by its function stand_in_openhaptics().
struct OpenHapticsState {
    std::atomic<bool> plugged{true};      ///< false: frames end in a communication error, opening fails
    std::atomic<bool> servo_calls{true};  ///< false: the scheduler stops calling
    std::atomic<int> servo_period_us{1000};
    std::atomic<bool> frozen{false};       ///< the servo calls, but no reading changes
    std::atomic<bool> not_finite{false};   ///< the position is NaN
    std::atomic<bool> left_handed{false};  ///< the transform mirrors
    std::atomic<double> shift_mm{0.0};     ///< added to x in one step
    std::atomic<int> buttons{0};
    std::atomic<int> opened{0};  ///< number of times that the device was opened
    std::atomic<bool> forces_on{false};
    std::array<std::atomic<double>, 3> force{};  ///< [N], last set
};

}  // namespace eti::stand_in
