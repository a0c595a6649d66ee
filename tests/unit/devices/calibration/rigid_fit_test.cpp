// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/calibration/rigid_fit.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "common/math/random.hpp"
#include "tests/support/error_of.hpp"

namespace eti::devices {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

Isometry3d truth() {
    Isometry3d pose = Isometry3d::Identity();
    pose.linear() = Eigen::AngleAxisd(2.1, Vector3d(1, 2, -3).normalized()).toRotationMatrix();
    pose.translation() = Vector3d(0.3, -0.2, 0.15);
    return pose;
}

/// Corners of a box of 100 x 60 x 40 mm, measured without noise by a device placed at truth().
std::vector<PointPair> box() {
    std::vector<PointPair> pairs;
    for (int corner = 0; corner < 8; ++corner) {
        const Vector3d p(corner & 1 ? 0.05 : -0.05, corner & 2 ? 0.03 : -0.03, corner & 4 ? 0.02 : -0.02);
        pairs.push_back({std::to_string(corner), truth().inverse() * p, p});
    }
    return pairs;
}

std::string refusal(const std::vector<PointPair>& pairs) {
    return test::error_of<CalibrationError>([&] { (void)fit_robustly(pairs); });
}

double apart(const Isometry3d& a, const Isometry3d& b) {
    return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

TEST(RigidFit, IsExactWithoutNoise) {
    const RigidFit fit = fit_robustly(box());
    // An SVD of 3 x 3 in doubles.
    EXPECT_LT(apart(fit.transform, truth()), 1e-12);
    EXPECT_LT(fit.fiducial_error, 1e-12);
    EXPECT_LT(fit.left_out_error, 1e-12);
    EXPECT_EQ(fit.advice, "");
}

// All points in one plane: the cross-covariance is singular, and the plain SVD solution may mirror.
TEST(RigidFit, NeverMirrors) {
    auto pairs = box();
    pairs.resize(4);
    EXPECT_LT(apart(fit_rigid(pairs), truth()), 1e-12);
    EXPECT_NEAR(fit_rigid(pairs).linear().determinant(), 1.0, 1e-12);
    // Points measured by a mirroring device fit no rigid transform, and none is invented.
    auto mirrored = box();
    for (PointPair& pair : mirrored) {
        pair.device.x() = -pair.device.x();
    }
    EXPECT_NEAR(fit_rigid(mirrored).linear().determinant(), 1.0, 1e-12);
    EXPECT_THAT(refusal(mirrored), HasSubstr("mirrored"));
}

TEST(RigidFit, CoplanarPointsLeaveHandednessOpen) {
    EXPECT_FALSE(fit_robustly(box()).handedness_ambiguous);
    auto flat = box();
    flat.resize(4);
    EXPECT_TRUE(fit_robustly(flat).handedness_ambiguous);
    // Coplanar points from a mirroring device, which a box reveals, fit without residual.
    for (PointPair& pair : flat) {
        pair.device.x() = -pair.device.x();
    }
    const RigidFit mirrored = fit_robustly(flat);
    EXPECT_LT(mirrored.fiducial_error, 1e-12);
    EXPECT_TRUE(mirrored.handedness_ambiguous);
}

// FRE's expectation: FLE^2 (1 - 2 / N) (Sibson 1979; Fitzpatrick, West & Maurer 1998).
TEST(RigidFit, FiducialErrorHasItsExpectedSize) {
    Random random(3);
    constexpr double sigma = 0.4e-3;  // per axis
    double sum = 0.0;
    constexpr int trials = 2000;
    for (int k = 0; k < trials; ++k) {
        auto pairs = box();
        for (PointPair& pair : pairs) {
            for (int axis = 0; axis < 3; ++axis) {
                pair.device[axis] += sigma * static_cast<double>(random.normal());
            }
        }
        const RigidFit fit = fit_robustly(pairs);
        sum += fit.fiducial_error * fit.fiducial_error;
        EXPECT_GT(fit.left_out_error, fit.fiducial_error)
            << "leaving a point out tells more than its residual";
    }
    const double expected = 3.0 * sigma * sigma * (1.0 - 2.0 / 8.0);
    // The sum over 2000 trials of about 18 degrees of freedom scatters by sqrt(2 / 36000) = 0.75 %; four of
    // it.
    EXPECT_NEAR(sum / trials / expected, 1.0, 0.03);
}

TEST(RigidFit, OutliersAreRejected) {
    auto pairs = box();
    pairs[2].device += Vector3d(0.02, 0, 0);
    pairs[5].device += Vector3d(0, -0.05, 0.03);
    const RigidFit fit = fit_robustly(pairs);
    EXPECT_LT(apart(fit.transform, truth()), 1e-12);
    EXPECT_EQ(fit.used, std::vector<bool>({true, true, false, true, true, false, true, true}));
    EXPECT_NEAR(fit.residual[2], 0.02, 1e-9);
    EXPECT_LT(fit.fiducial_error, 1e-9);
    pairs[1].device += Vector3d(0.02, 0.03, 0);
    EXPECT_THAT(refusal(pairs), AllOf(HasSubstr("5 of 8"), HasSubstr("again")));
}

TEST(RigidFit, SampledFitMatchesForManyPoints) {
    Random random(8);
    std::vector<PointPair> pairs;
    for (int i = 0; i < 60; ++i) {
        const Vector3d p(static_cast<double>(random.normal()), static_cast<double>(random.normal()),
                         static_cast<double>(random.normal()));
        pairs.push_back({"", truth().inverse() * (0.05 * p), 0.05 * p});
    }
    for (std::size_t i = 0; i < 12; ++i) {
        pairs[5 * i].device += Vector3d(0.03, 0.01, 0);
    }
    EXPECT_LT(apart(fit_robustly(pairs).transform, truth()), 1e-12);
}

TEST(RigidFit, DegeneratePointsErrorNamesTheRemedy) {
    auto pairs = box();
    pairs.resize(3);
    EXPECT_THAT(refusal(pairs), AllOf(HasSubstr("3 pairs"), HasSubstr("Collect 1 more")));
    EXPECT_THAT(refusal({}), HasSubstr("Collect 4 more"));
    std::vector<PointPair> line;
    for (int i = 0; i < 8; ++i) {
        const Vector3d p(0.001 * (i % 2), 0, 0.02 * i);
        line.push_back({"", truth().inverse() * p, p});
    }
    EXPECT_THAT(refusal(line),
                AllOf(HasSubstr("on a line"), HasSubstr("off that line"), HasSubstr("left-right")));
    auto bad = box();
    bad[3].device.y() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(refusal(bad), HasSubstr("'3'"));
}

TEST(RigidFit, AdviceNamesWhereToCollectMore) {
    std::vector<PointPair> narrow;
    for (int i = 0; i < 8; ++i) {
        const Vector3d p(i % 2 ? 0.007 : -0.007, 0, 0.02 * i);
        narrow.push_back({"", truth().inverse() * p, p});
    }
    EXPECT_THAT(fit_robustly(narrow).advice, HasSubstr("left-right"));
}

std::vector<Isometry3d> swings(double cone, double noise) {
    Random random(4);
    std::vector<Isometry3d> poses;
    const Vector3d tip(0.01, -0.02, 0.1), pivot(0.2, 0.3, -0.1);
    for (int i = 0; i < 400; ++i) {
        const double around = 0.1 * i;
        const Vector3d axis(std::cos(around), std::sin(around), 0.0);
        Isometry3d pose = Isometry3d::Identity();
        pose.linear() =
            Eigen::AngleAxisd(cone * static_cast<double>(random.uniform()), axis).toRotationMatrix();
        pose.translation() = pivot - pose.linear() * tip;
        for (int k = 0; k < 3; ++k) {
            pose.translation()[k] += noise * static_cast<double>(random.normal());
        }
        poses.push_back(pose);
    }
    return poses;
}

TEST(PivotFit, FindsTheTip) {
    const PivotFit exact = fit_pivot(swings(0.7, 0.0));
    EXPECT_LT((exact.tip - Vector3d(0.01, -0.02, 0.1)).norm(), 1e-12);
    EXPECT_LT((exact.pivot - Vector3d(0.2, 0.3, -0.1)).norm(), 1e-12);
    EXPECT_LT(exact.error, 1e-12);
    const PivotFit noisy = fit_pivot(swings(0.7, 0.5e-3));
    // 0.5 mm per axis over 400 poses; the smallest singular value per root pose is about 0.25, so the tip's
    // deviation per axis is 0.5 / (0.25 * 20) = 0.1 mm: four of them.
    EXPECT_LT((noisy.tip - Vector3d(0.01, -0.02, 0.1)).norm(), 0.4e-3);
    EXPECT_NEAR(noisy.error, std::sqrt(3.0) * 0.5e-3, 0.05e-3);
}

std::string pivot_refusal(const std::vector<Isometry3d>& poses) {
    return test::error_of<CalibrationError>([&] { (void)fit_pivot(poses); });
}

TEST(PivotFit, ATipThatSlippedIsRefused) {
    auto slipped = swings(0.7, 0.2e-3);
    for (std::size_t i = slipped.size() / 2; i < slipped.size(); ++i) {
        slipped[i].translation().x() += 0.02;
    }
    // Half the poses 10 mm to either side of their mean: near 10 mm RMS, less what the fit compensates.
    EXPECT_THAT(pivot_refusal(slipped), AllOf(HasSubstr("did not rest"), HasSubstr("at most 3 mm"),
                                              HasSubstr("w x y z"), Not(HasSubstr("write w first"))));
    // The coarsest sensor, 1.4 mm RMS over the three axes, is accepted.
    EXPECT_EQ(pivot_refusal(swings(0.7, 1.4e-3 / std::sqrt(3.0))), "");
}

TEST(PivotFit, WrongQuaternionOrderIsNamed) {
    auto last = swings(0.7, 0.2e-3), inverse = last;
    for (Isometry3d& pose : last) {
        const Eigen::Quaterniond q(pose.linear());
        pose.linear() = Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()).toRotationMatrix();
    }
    for (Isometry3d& pose : inverse) {
        pose.linear().transposeInPlace();
    }
    EXPECT_THAT(pivot_refusal(last), AllOf(HasSubstr("x y z w"), HasSubstr("write w first")));
    EXPECT_THAT(pivot_refusal(inverse), HasSubstr("inverse rotations"));
}

TEST(PivotFit, PositionsInMetresAreRefused) {
    auto metres = swings(0.7, 0.2e-3);
    for (Isometry3d& pose : metres) {
        pose.translation() *= 1e-3;  // read as millimetres
    }
    EXPECT_THAT(pivot_refusal(metres), AllOf(HasSubstr("0.10"), HasSubstr("in metres?")));
}

TEST(PivotFit, TooLittleTurningAndTooFewPosesAreRefused) {
    EXPECT_THROW((void)fit_pivot(swings(0.05, 0.0)), CalibrationError);
    auto few = swings(0.7, 0.0);
    few.resize(19);
    EXPECT_THROW((void)fit_pivot(few), CalibrationError);
}

}  // namespace
}  // namespace eti::devices
