// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/calibration/rigid_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "common/math/random.hpp"

namespace eti::devices {

namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double agreeing_share = 0.75;
constexpr std::size_t min_poses = 20;
// Poses that turn the tool about its tip by an angle a determine the tip's position to about the noise over
// sin(a), the smallest singular value of the stacked system per square root of the poses. A cone of about 12
// deg reaches 0.1.
constexpr double min_turning = 0.1;

/// Least-squares rotation and translation between the pairs (Umeyama, IEEE TPAMI 13:376, 1991, without
/// scale): from the singular vectors of the points' covariance, with reflections excluded.
Isometry3d fit(std::span<const PointPair> pairs, std::span<const std::size_t> which) {
    const auto count = static_cast<double>(which.size());
    Vector3d from = Vector3d::Zero(), to = Vector3d::Zero();
    for (const std::size_t i : which) {
        from += pairs[i].device / count;
        to += pairs[i].patient / count;
    }
    Matrix3d covariance = Matrix3d::Zero();
    for (const std::size_t i : which) {
        covariance += (pairs[i].patient - to) * (pairs[i].device - from).transpose();
    }
    const Eigen::JacobiSVD<Matrix3d, Eigen::NoQRPreconditioner> svd(
        covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const bool mirrored = svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0;
    Isometry3d out = Isometry3d::Identity();
    out.linear() =
        svd.matrixU() * Vector3d(1.0, 1.0, mirrored ? -1.0 : 1.0).asDiagonal() * svd.matrixV().transpose();
    out.translation() = to - out.linear() * from;
    return out;
}

double miss(const PointPair& pair, const Isometry3d& transform) {
    return (transform * pair.device - pair.patient).norm();
}

/// Principal spreads [m] of the patient's points in ascending order, and their directions.
struct Spread {
    Vector3d size;
    Matrix3d direction;
    Vector3d centre = Vector3d::Zero();
};

Spread spread_of(std::span<const PointPair> pairs, std::span<const std::size_t> which) {
    Spread out;
    for (const std::size_t i : which) {
        out.centre += pairs[i].patient / static_cast<double>(which.size());
    }
    Matrix3d covariance = Matrix3d::Zero();
    for (const std::size_t i : which) {
        const Vector3d d = pairs[i].patient - out.centre;
        covariance += d * d.transpose() / static_cast<double>(which.size());
    }
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(covariance);
    out.size = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    out.direction = solver.eigenvectors();
    return out;
}

/// The patient axis closest to a direction: "left-right", "front-back" or "head-feet".
std::string_view name_of_direction(const Vector3d& direction) {
    Eigen::Index axis = 0;
    direction.cwiseAbs().maxCoeff(&axis);
    constexpr std::array<std::string_view, 3> names = {"left-right", "front-back", "head-feet"};
    return names[static_cast<std::size_t>(axis)];
}

std::vector<std::size_t> agreeing(std::span<const PointPair> pairs, const Isometry3d& transform,
                                  double within) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (miss(pairs[i], transform) <= within) {
            found.push_back(i);
        }
    }
    return found;
}

/// Largest set of pairs that one transform fits to within the limit.
std::vector<std::size_t> largest_agreement(std::span<const PointPair> pairs, const FitSettings& settings) {
    const std::size_t n = pairs.size();
    std::vector<std::size_t> best;
    const auto try_triple = [&](const std::array<std::size_t, 3>& triple) {
        if (spread_of(pairs, triple).size[1] < 0.5 * settings.min_spread) {
            return;
        }
        auto found = agreeing(pairs, fit(pairs, triple), settings.outlier);
        // Refit to all inliers: a triple's own noise is larger than theirs.
        if (found.size() >= 3) {
            found = agreeing(pairs, fit(pairs, found), settings.outlier);
        }
        if (found.size() > best.size()) {
            best = std::move(found);
        }
    };
    if (n * (n - 1) * (n - 2) / 6 <= settings.max_samples) {
        for (std::size_t a = 0; a < n; ++a) {
            for (std::size_t b = a + 1; b < n; ++b) {
                for (std::size_t c = b + 1; c < n; ++c) {
                    try_triple({a, b, c});
                }
            }
        }
        return best;
    }
    Random random(settings.seed);
    for (std::size_t k = 0; k < settings.max_samples; ++k) {
        const std::array<std::size_t, 3> triple{random.bits() % n, random.bits() % n, random.bits() % n};
        if (triple[0] != triple[1] && triple[1] != triple[2] && triple[0] != triple[2]) {
            try_triple(triple);
        }
    }
    return best;
}

void refuse_thin(const Spread& spread, const FitSettings& settings) {
    if (spread.size[1] < settings.min_spread) {
        throw CalibrationError(fmt::format(
            "the points lie on a line (RMS {:.1f} mm across it, at least {:.0f} mm are needed), which leaves "
            "the rotation about it undetermined. Collect more points off that line, {} of it",
            1e3 * spread.size[1], 1e3 * settings.min_spread, name_of_direction(spread.direction.col(1))));
    }
}

}  // namespace

Isometry3d fit_rigid(std::span<const PointPair> pairs) {
    std::vector<std::size_t> all(pairs.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return fit(pairs, all);
}

RigidFit fit_robustly(std::span<const PointPair> pairs, const FitSettings& settings) {
    if (pairs.size() < settings.min_pairs) {
        throw CalibrationError(fmt::format(
            "{} pairs of points, at least {} are needed. Collect {} more, far apart and not on a line",
            pairs.size(), settings.min_pairs, settings.min_pairs - pairs.size()));
    }
    for (const PointPair& pair : pairs) {
        if (!pair.device.allFinite() || !pair.patient.allFinite()) {
            throw CalibrationError(
                fmt::format("point '{}' has a coordinate that is not a number", pair.name));
        }
    }
    std::vector<std::size_t> all(pairs.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    refuse_thin(spread_of(pairs, all), settings);

    const std::vector<std::size_t> inliers = largest_agreement(pairs, settings);
    if (static_cast<double>(inliers.size()) < agreeing_share * static_cast<double>(pairs.size()) ||
        inliers.size() < 3) {
        throw CalibrationError(fmt::format(
            "only {} of {} points agree within {:.0f} mm. Touch the named points again, in their order; if "
            "each is correct by itself, the device's axes are mirrored or the phantom is a different one",
            inliers.size(), pairs.size(), 1e3 * settings.outlier));
    }
    const Spread spread = spread_of(pairs, inliers);
    refuse_thin(spread, settings);

    RigidFit out;
    // For mirrored points, the best rotation puts each as far on the other side of their plane as it was on
    // this one. They miss by twice the spread across it, and agree where that is within the limit.
    out.handedness_ambiguous = 2.0 * spread.size[0] < settings.outlier;
    out.transform = fit(pairs, inliers);
    out.used.assign(pairs.size(), false);
    for (const PointPair& pair : pairs) {
        out.residual.push_back(miss(pair, out.transform));
    }
    double sum = 0.0, left_out = 0.0;
    for (const std::size_t i : inliers) {
        out.used[i] = true;
        sum += out.residual[i] * out.residual[i];
        std::vector<std::size_t> others;
        std::ranges::copy_if(inliers, std::back_inserter(others), [&](std::size_t k) { return k != i; });
        // Without it the others may lie on a line; the fit then says nothing about it.
        const double alone =
            others.size() >= 3 && spread_of(pairs, others).size[1] >= 0.5 * settings.min_spread
                ? miss(pairs[i], fit(pairs, others))
                : out.residual[i];
        left_out += alone * alone;
    }
    const auto count = static_cast<double>(inliers.size());
    out.fiducial_error = std::sqrt(sum / count);
    out.left_out_error = std::sqrt(left_out / count);
    if (spread.size[1] < 3.0 * settings.min_spread || inliers.size() < 6) {
        out.advice = fmt::format("collect more points farther {} of the others",
                                 name_of_direction(spread.direction.col(1)));
    }
    return out;
}

namespace {

/// Least squares of R_i tip - pivot = -t_i over all poses, unchecked; `turning` measures how well they
/// determine the tip.
/// With the means R, t and u of R_i, t_i and R_i^T t_i the normal equations are
/// (1 - R^T R) tip = R^T t - u,   pivot = R tip + t.
/// The stacked system's smallest singular value, per square root of the poses, is sqrt(1 - s), where s is the
/// largest singular value of R.
PivotFit solve_pivot(std::span<const Isometry3d> poses, double& turning) {
    const auto count = static_cast<double>(poses.size());
    Matrix3d mean = Matrix3d::Zero();
    Vector3d place = Vector3d::Zero(), turned_back = Vector3d::Zero();
    for (const Isometry3d& pose : poses) {
        mean += pose.linear() / count;
        place += pose.translation() / count;
        turned_back += pose.linear().transpose() * pose.translation() / count;
    }
    const Eigen::SelfAdjointEigenSolver<Matrix3d> squares(mean.transpose() * mean);
    turning = std::sqrt(std::max(0.0, 1.0 - std::sqrt(squares.eigenvalues()[2])));
    const Vector3d right = squares.eigenvectors().transpose() * (mean.transpose() * place - turned_back);
    PivotFit out;
    out.tip = squares.eigenvectors() * (right.array() / (1.0 - squares.eigenvalues().array())).matrix();
    out.pivot = mean * out.tip + place;
    double sum = 0.0;
    for (const Isometry3d& pose : poses) {
        sum += (pose * out.tip - out.pivot).squaredNorm();
    }
    out.error = std::sqrt(sum / static_cast<double>(poses.size()));
    return out;
}

/// Another order or unit of the poses' numbers, if that explains why they do not fit; else empty.
std::string other_order(std::span<const Isometry3d> poses, const PivotSettings& settings) {
    const auto error_of = [&](const auto& reading) {
        std::vector<Isometry3d> others(poses.begin(), poses.end());
        for (Isometry3d& pose : others) {
            pose.linear() = reading(Eigen::Quaterniond(pose.linear())).toRotationMatrix();
        }
        double turning = 0.0;
        const PivotFit fit = solve_pivot(others, turning);
        return turning < min_turning ? settings.largest_error : fit.error;
    };
    // Reads numbers x y z w as w x y z.
    const double last =
        error_of([](const Eigen::Quaterniond& q) { return Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()); });
    const double inverse = error_of([](const Eigen::Quaterniond& q) { return q.conjugate(); });
    if (std::min(last, inverse) >= settings.largest_error) {
        return "";
    }
    return last < inverse
               ? fmt::format("; with quaternions in the order x y z w the error is {:.2f} mm: write w first",
                             1e3 * last)
               : fmt::format(
                     "; with inverse rotations the error is {:.2f} mm: give the sensor's rotation in the "
                     "device's frame",
                     1e3 * inverse);
}

}  // namespace

PivotFit fit_pivot(std::span<const Isometry3d> poses, const PivotSettings& settings) {
    if (poses.size() < min_poses) {
        throw CalibrationError(
            fmt::format("{} poses, at least {} are needed. Swing the tool about its tip for longer",
                        poses.size(), min_poses));
    }
    for (std::size_t i = 0; i < poses.size(); ++i) {
        if (!poses[i].matrix().allFinite()) {
            throw CalibrationError(fmt::format("pose {} is not finite", i + 1));
        }
    }
    double turning = 0.0;
    const PivotFit out = solve_pivot(poses, turning);
    if (turning < min_turning) {
        throw CalibrationError(
            "the tool was rotated too little to locate its tip. Keep the tip in place and swing the handle "
            "by 30 deg or more, in all directions");
    }
    if (!(out.error <= settings.largest_error)) {
        throw CalibrationError(fmt::format(
            "the tip did not rest: the poses deviate from one point by {:.2f} mm RMS, expected at most {:g} "
            "mm{}. Keep the tip in its dimple and swing again; give measured poses as x y z [mm] and w x y z",
            1e3 * out.error, 1e3 * settings.largest_error, other_order(poses, settings)));
    }
    const double distance = out.tip.norm();
    if (distance < settings.nearest || distance > settings.farthest) {
        throw CalibrationError(
            fmt::format("the tip lies {:.3g} mm from the sensor, expected {:g} to {:g} mm{}. Give positions "
                        "in millimetres, and poses of the sensor that is fixed to the tool",
                        1e3 * distance, 1e3 * settings.nearest, 1e3 * settings.farthest,
                        1e3 * distance >= settings.nearest && 1e3 * distance <= settings.farthest
                            ? "; are the positions in metres?"
                            : ""));
    }
    return out;
}

}  // namespace eti::devices
