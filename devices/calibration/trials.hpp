// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "common/math/random.hpp"
#include "devices/calibration/rigid_fit.hpp"

namespace eti::devices {

/// How far a device and the hand that touches points with it are off.
struct SensorNoise {
    std::string_view device;
    double position;  ///< [m], RMS distance of a measured point from where it is
    std::string_view source;
};

/// Of the devices that need calibrating. From the vendors' data sheets by hearsay: no first-hand copy was
/// found, so the figures are not verified.
[[nodiscard]] std::span<const SensorNoise> sensor_noises();

/// A person who rests a tip in a dimple and presses the key does not sit in its middle: RMS distance [m].
/// An assumption, half of a dimple's radius.
inline constexpr double touching_noise = 0.5e-3;

/// The points of `board` (their patient places) as a device measures them that a person touches each with
/// once; `to_patient`: where it stands.
[[nodiscard]] std::vector<PointPair> touched(std::span<const PointPair> board, const SensorNoise& device,
                                             const Eigen::Isometry3d& to_patient, Random& random);

/// What came of simulated calibrations: the error [m] at the targets, in the mouth, over all trials.
struct TrialResult {
    double median = 0.0, percentile_95 = 0.0, worst = 0.0;
    int refused = 0;  ///< trials that were refused
};

/// Calibrates `trials` times with the points of `board` (their patient places), each measured with `noise`
/// about an unknown pose of the device, one in ten wrong by 10 to 50 mm where `outliers` is set.
[[nodiscard]] TrialResult simulate_calibrations(std::span<const PointPair> board, const SensorNoise& noise,
                                                int trials, bool outliers, std::uint64_t seed);

}  // namespace eti::devices
