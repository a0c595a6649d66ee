// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/calibration/trials.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace eti::devices {

namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

// Target positions of the tips of blade and tube: gum, vallecula, glottis, carina of a term newborn, to a
// centimetre.
const std::array<Vector3d, 4> targets = {
    {{0, 0, 0}, {0, 0.025, -0.05}, {0, 0.03, -0.065}, {0, 0.05, -0.115}}};

double normal(Random& random) {
    return static_cast<double>(random.normal());
}

Vector3d noise(Random& random, double rms) {
    const double sigma = rms / std::sqrt(3.0);
    return sigma * Vector3d(normal(random), normal(random), normal(random));
}

Isometry3d any_pose(Random& random) {
    Eigen::Quaterniond turn(normal(random), normal(random), normal(random), normal(random));
    return Eigen::Translation3d(0.3 * Vector3d(normal(random), normal(random), normal(random))) *
           turn.normalized();
}

double quantile(std::span<const double> sorted, double q) {
    return sorted.empty() ? 0.0
                          : sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

std::span<const SensorNoise> sensor_noise_table() {
    static constexpr std::array<SensorNoise, 3> table = {{
        {"Touch", 0.055e-3, "3D Systems, Touch: nominal position resolution 0.055 mm"},
        {"Touch X", 0.023e-3, "3D Systems, Touch X: nominal position resolution 0.023 mm"},
        {"trakSTAR", 1.4e-3, "Ascension, 3D Guidance trakSTAR: static accuracy 1.4 mm RMS"},
    }};
    return table;
}

std::vector<PointPair> simulate_touches(std::span<const PointPair> board, const SensorNoise& device,
                                        const Isometry3d& to_patient, Random& random) {
    const Isometry3d back = to_patient.inverse();
    std::vector<PointPair> pairs(board.begin(), board.end());
    for (PointPair& pair : pairs) {
        pair.device = back * pair.patient + noise(random, device.position) + noise(random, touching_noise);
    }
    return pairs;
}

TrialResult simulate_calibrations(std::span<const PointPair> board, const SensorNoise& device, int trials,
                                  bool outliers, std::uint64_t seed) {
    Random random(seed);
    TrialResult out;
    std::vector<double> errors;
    for (int trial = 0; trial < trials; ++trial) {
        const Isometry3d truth = any_pose(random);
        const Isometry3d back = truth.inverse();
        std::vector<PointPair> pairs = simulate_touches(board, device, truth, random);
        if (outliers) {
            const std::size_t wrong = (pairs.size() + 9) / 10;
            for (std::size_t k = 0; k < wrong; ++k) {
                const Vector3d way = noise(random, 1.0).normalized();
                pairs[random.bits() % pairs.size()].device +=
                    (0.01 + 0.04 * static_cast<double>(random.uniform())) * way;
            }
        }
        try {
            const RigidFit fit = fit_robustly(pairs);
            for (const Vector3d& target : targets) {
                errors.push_back((fit.transform * (back * target) - target).norm());
            }
        } catch (const CalibrationError&) {
            ++out.refused;
        }
    }
    std::ranges::sort(errors);
    out.median = quantile(errors, 0.5);
    out.percentile_95 = quantile(errors, 0.95);
    out.worst = quantile(errors, 1.0);
    return out;
}

}  // namespace eti::devices
