// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/calibration/trials.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "devices/calibration/point_file.hpp"

namespace eti::devices {
namespace {

// Xiao et al. 2020 registered within 2 mm. With the shipped board, every device, with and without wrongly
// touched points, over 1000 trials.
TEST(Trials, TheShippedBoardRegistersWithinTwoMillimetres) {
    const auto board = load_points(BOARD, false);
    for (const SensorNoise& noise : sensor_noise_table()) {
        for (const bool outliers : {false, true}) {
            const TrialResult result = simulate_calibrations(board, noise, 1000, outliers, 7);
            EXPECT_LT(result.percentile_95, 2e-3) << noise.device << outliers;
            // A rejected calibration must be repeated, which must be rare.
            EXPECT_LE(result.refused, 10) << noise.device << outliers;
            EXPECT_GT(result.median, 0.05e-3) << "noise reached nothing";
            RecordProperty(std::string(noise.device) + (outliers ? "_outliers" : "") + "_worst_mm",
                           std::to_string(1e3 * result.worst));
        }
    }
}

// The error at a target is proportional to the noise of the points to first order (Fitzpatrick et al. 1998,
// IEEE Trans Med Imaging 17:694), and what a person adds in touching is independent of the device's. The
// median of 400 trials scatters by 1.25 / sqrt(400) of its spread, 3 % for both.
TEST(Trials, ErrorIsProportionalToNoise) {
    const auto board = load_points(BOARD, false);
    const double noise = 1e-3;
    const auto error = [&](double position) {
        return simulate_calibrations(board, SensorNoise{"", position, ""}, 400, false, 7).median;
    };
    const double expected = std::hypot(2.0 * noise, touching_noise) / std::hypot(noise, touching_noise);
    EXPECT_NEAR(error(2.0 * noise) / error(noise), expected, 0.03 * expected);
}

}  // namespace
}  // namespace eti::devices
