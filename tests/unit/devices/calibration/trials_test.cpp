// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/calibration/trials.hpp"

#include <gtest/gtest.h>

#include "devices/calibration/point_file.hpp"

namespace eti::devices {
namespace {

// Xiao et al. 2020 registered within 2 mm. With the shipped board, every device, with and without points
// touched wrongly, over 1000 trials.
TEST(Trials, TheShippedBoardRegistersWithinTwoMillimetres) {
    const auto board = load_points(BOARD, false);
    for (const SensorNoise& noise : sensor_noises()) {
        for (const bool outliers : {false, true}) {
            const TrialResult result = simulate_calibrations(board, noise, 1000, outliers, 7);
            EXPECT_LT(result.percentile_95, 2e-3) << noise.device << outliers;
            // Refused, a calibration is repeated; it must be rare.
            EXPECT_LE(result.refused, 10) << noise.device << outliers;
            EXPECT_GT(result.median, 0.05e-3) << "noise reached nothing";
            RecordProperty(std::string(noise.device) + (outliers ? "_outliers" : "") + "_worst_mm",
                           std::to_string(1e3 * result.worst));
        }
    }
}

TEST(Trials, NoiseTwiceAsLargeIsNoticed) {
    const auto board = load_points(BOARD, false);
    const SensorNoise poor{"poor", 6e-3, ""};
    EXPECT_GT(simulate_calibrations(board, poor, 200, false, 7).percentile_95, 2e-3);
}

}  // namespace
}  // namespace eti::devices
