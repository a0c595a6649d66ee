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

/// Measurements that do not determine what is asked for; the text says what to measure more.
class CalibrationError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The same point as the device measures it and where it is in the patient frame [m].
struct PointPair {
    std::string name;
    Eigen::Vector3d device = Eigen::Vector3d::Zero();
    Eigen::Vector3d patient = Eigen::Vector3d::Zero();
};

struct FitSettings {
    std::size_t fewest = 4;           ///< pairs; three determine the transform and leave nothing to check it
    double thinnest = 5e-3;           ///< [m], least RMS spread across the line that fits the points best
    double outlier = 4e-3;            ///< [m], a pair that misses by more is left out; twice the goal
    std::size_t most_samples = 2000;  ///< triples that RANSAC tries; all of them up to 23 pairs
    std::uint64_t seed = 1;
};

/// Device to patient, and how good it is.
struct RigidFit {
    Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();  ///< patient = transform * device
    std::vector<bool> used;                                       ///< per pair; false: left out as an outlier
    std::vector<double> residual;                                 ///< [m], per pair, also of those left out
    double fiducial_error = 0.0;  ///< [m], RMS residual of the used pairs (FRE)
    double left_out_error = 0.0;  ///< [m], RMS over the used pairs of how far a fit without the pair
                                  ///< misses it
    std::string advice;           ///< where more points would help most; empty when none are needed
    /// The used points lie so near one plane that a device whose axes are mirrored would fit as well.
    bool handedness_open = false;
};

/// Least-squares rigid transform without scale (Arun, Huang & Blostein 1987; the sign that keeps it from
/// mirroring: Umeyama 1991). The weights are all one. Three pairs that span a plane are enough.
[[nodiscard]] Eigen::Isometry3d fit_rigid(std::span<const PointPair> pairs);

/// The fit to as many pairs as agree with each other: RANSAC (Fischler & Bolles 1981) over triples, then
/// least squares. Throws CalibrationError when there are too few pairs, when they lie on a line, or when
/// fewer than three quarters agree.
[[nodiscard]] RigidFit fit_robustly(std::span<const PointPair> pairs, const FitSettings& settings = {});

/// How the device's poses are turned into poses of the tool's tip.
struct PivotFit {
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();    ///< [m], in the frame of the sensor on the tool
    Eigen::Vector3d pivot = Eigen::Vector3d::Zero();  ///< [m], in the device's frame: where the tip stood
    double error = 0.0;                               ///< [m], RMS over the poses
};

struct PivotSettings {
    double largest_error = 3e-3;               ///< [m] RMS; twice that of the coarsest sensor, a trakSTAR
    double nearest = 5e-3, farthest = 500e-3;  ///< [m], from the sensor to the tip of a tool in a hand
};

/// The tip of a tool that was turned about its resting tip: least squares over R_i tip + t_i = pivot
/// (the algebraic one-step method; Yaniv, "Which pivot calibration?", SPIE 9415, 2015). Throws
/// CalibrationError for fewer than 20 poses, when they turn by too little to tell, when the tip did not rest,
/// or when it lies where no tool has one. The text says so where another order of the quaternions' numbers
/// or metres for millimetres would explain it.
[[nodiscard]] PivotFit fit_pivot(std::span<const Eigen::Isometry3d> poses,
                                 const PivotSettings& settings = {});

}  // namespace eti::devices
