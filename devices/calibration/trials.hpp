// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "common/math/random.hpp"
#include "devices/calibration/rigid_fit.hpp"

namespace eti::devices {

/// Errors of a device and of the hand that touches points with it.
struct SensorNoise {
    std::string_view device;
    double position;  ///< [m], RMS error of a measured point
    std::string_view source;
};

/// For devices that need calibration. Secondary citations of the vendors' data sheets: no original was found,
/// so the figures are not verified.
[[nodiscard]] std::span<const SensorNoise> sensor_noise_table();

/// RMS distance [m] from the middle of a dimple of a tip rested in it by hand. An assumption: half of a
/// dimple's radius.
inline constexpr double touching_noise = 0.5e-3;

/// Simulates a device that touches each point of `board` (patient positions) once; `to_patient`: its pose.
[[nodiscard]] std::vector<PointPair> simulate_touches(std::span<const PointPair> board,
                                                      const SensorNoise& device,
                                                      const Eigen::Isometry3d& to_patient, Random& random);

/// Results of simulated calibrations: the error [m] at the targets in the mouth over all trials.
struct TrialResult {
    double median = 0.0, percentile_95 = 0.0, worst = 0.0;
    int refused = 0;  ///< trials that failed
};

/// Calibrates `trials` times with the points of `board` (patient positions), each measured with `noise` at an
/// unknown pose of the device. With `outliers`, one point in ten is wrong by 10 to 50 mm.
[[nodiscard]] TrialResult simulate_calibrations(std::span<const PointPair> board, const SensorNoise& noise,
                                                int trials, bool outliers, std::uint64_t seed);

}  // namespace eti::devices
