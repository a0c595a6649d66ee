// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace eti::devices {

/// The measurements do not determine the result; the text states what else to measure.
class CalibrationError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A point in the device frame and in the patient frame [m].
struct PointPair {
    std::string name;
    Eigen::Vector3d device = Eigen::Vector3d::Zero();
    Eigen::Vector3d patient = Eigen::Vector3d::Zero();
};

struct FitSettings {
    std::size_t min_pairs = 4;       ///< pairs; three determine the transform without redundancy
    double min_spread = 5e-3;        ///< [m], least accepted RMS spread across the best-fitting line
    double outlier = 4e-3;           ///< [m], larger residuals are outliers; twice the goal
    std::size_t max_samples = 2000;  ///< triples that RANSAC tries; all of them up to 23 pairs
    std::uint64_t seed = 1;
};

/// Transform from device to patient, and its quality.
struct RigidFit {
    Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();  ///< patient = transform * device
    std::vector<bool> used;                                       ///< per pair; false: rejected as an outlier
    std::vector<double> residual;                                 ///< [m], per pair, including rejected ones
    double fiducial_error = 0.0;  ///< [m], RMS residual of the used pairs (FRE)
    double left_out_error = 0.0;  ///< [m], RMS leave-one-out residual of the used pairs
    std::string advice;           ///< where more points would help most; empty if not needed
    /// The used points are so nearly coplanar that a device with mirrored axes would fit as well.
    bool handedness_ambiguous = false;
};

/// Least-squares rigid transform without scale (Arun, Huang & Blostein 1987; sign that excludes reflections:
/// Umeyama 1991). All weights are one. Three pairs that span a plane suffice.
[[nodiscard]] Eigen::Isometry3d fit_rigid(std::span<const PointPair> pairs);

/// Fit to the largest set of consistent pairs: RANSAC (Fischler & Bolles 1981) over triples, then least
/// squares. Throws CalibrationError when there are too few pairs, when they lie on a line, or when fewer than
/// three quarters agree.
[[nodiscard]] RigidFit fit_robustly(std::span<const PointPair> pairs, const FitSettings& settings = {});

/// Result of a pivot calibration.
struct PivotFit {
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();    ///< [m], in the frame of the sensor on the tool
    Eigen::Vector3d pivot = Eigen::Vector3d::Zero();  ///< [m], position of the tip, device frame
    double error = 0.0;                               ///< [m], RMS over the poses
};

struct PivotSettings {
    double largest_error = 3e-3;               ///< [m] RMS; twice that of the coarsest sensor, a trakSTAR
    double nearest = 5e-3, farthest = 500e-3;  ///< [m], from the sensor to the tip of a tool in a hand
};

/// Pivot calibration of a tool turned about its resting tip: least squares over R_i tip + t_i = pivot (the
/// algebraic one-step method; Yaniv, "Which pivot calibration?", SPIE 9415, 2015). Throws CalibrationError
/// for fewer than 20 poses, for too little rotation, when the tip did not rest, or when its position is
/// impossible for a tool. The text mentions another order of the quaternions' numbers, or metres instead of
/// millimetres, where that would explain the failure.
[[nodiscard]] PivotFit fit_pivot(std::span<const Eigen::Isometry3d> poses,
                                 const PivotSettings& settings = {});

}  // namespace eti::devices
