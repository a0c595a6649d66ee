// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <atomic>

namespace eti::stand_in {

/// Controls of the 3D Guidance stand-in for a test, returned by its function stand_in_trakstar().
struct TrakstarState {
    std::atomic<bool> plugged{true};
    std::atomic<bool> frozen{false};  ///< the records' timestamps do not advance
    std::atomic<int> status{0};       ///< of the sensor
    std::atomic<double> rate{80.0};   ///< [1/s], new records
    std::atomic<bool> not_finite{false};
    std::atomic<bool> left_handed{false};
    std::atomic<bool> other_hemisphere{false};  ///< the position's sign flips
    std::atomic<double> shift_mm{0.0};
    std::atomic<int> opened{0};
    std::atomic<int> format{-1}, sensor{-1};
    std::atomic<bool> millimetres{false};
};

}  // namespace eti::stand_in
