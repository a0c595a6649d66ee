// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/rod/rod_joint.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "common/math/random.hpp"
#include "server/pbd/rod/rod_chain.hpp"

namespace eti {
namespace {

// Derivatives of a joint's constraints against central differences of its own values, at bends up to
// 170 degrees. Step 1e-6 in double: truncation 1e-12 times third derivatives of order 100, rounding
// 1e-16 / 1e-6.
TEST(RodJoint, DerivativesMatchFiniteDifferences) {
    Random random(11);
    const auto vector = [&](float scale) {
        return Vec3d(Vec3f(random.normal(), random.normal(), random.normal()).cast<double>() * double{scale});
    };
    for (int trial = 0; trial < 200; ++trial) {
        pbd::RodSegment a;
        pbd::RodSegment b;
        a.behind = a.ahead = b.behind = 0.0025;
        b.ahead = 0.004;
        a.rotation = pbd::exp_rotation(vector(1.0f));
        const Vec3d bend = vector(1.0f).normalized() * (2.96 * double{random.uniform()});
        b.rotation = a.rotation * pbd::exp_rotation(bend);
        a.position = vector(0.01f);
        b.position = vector(0.01f);
        pbd::RodJoint joint;
        joint.rest = vector(0.1f);
        const pbd::RodJointState at = evaluate(joint, a, b);
        const Vec3d dx_a = vector(1.0f), w_a = vector(1.0f), dx_b = vector(1.0f), w_b = vector(1.0f);
        const auto moved = [&](double step) {
            pbd::RodSegment p = a;
            pbd::RodSegment q = b;
            p.position += step * dx_a;
            q.position += step * dx_b;
            p.rotation = pbd::exp_rotation(step * w_a) * p.rotation;
            q.rotation = pbd::exp_rotation(step * w_b) * q.rotation;
            return evaluate(joint, p, q);
        };
        const pbd::RodJointState plus = moved(1e-6);
        const pbd::RodJointState minus = moved(-1e-6);
        const Vec3d gap_rate = dx_a + w_a.cross(at.arm_a) - dx_b - w_b.cross(at.arm_b);
        EXPECT_LT(((plus.gap - minus.gap) / 2e-6 - gap_rate).norm(), 1e-8);
        EXPECT_LT(((plus.angle - minus.angle) / 2e-6 - at.turn * (w_b - w_a)).norm(), 1e-7);
        // Couplings are products of these derivatives.
        Eigen::Matrix<double, 6, 12> j = Eigen::Matrix<double, 6, 12>::Zero();
        j.block<3, 3>(0, 0) = Mat3f::Identity().cast<double>();
        j.block<3, 3>(0, 3) = -pbd::cross_matrix(at.arm_a);
        j.block<3, 3>(0, 6) = -Mat3f::Identity().cast<double>();
        j.block<3, 3>(0, 9) = pbd::cross_matrix(at.arm_b);
        j.block<3, 3>(3, 3) = -at.turn;
        j.block<3, 3>(3, 9) = at.turn;
        Eigen::Matrix<double, 12, 1> w;
        w << 2, 2, 2, 3, 3, 3, 5, 5, 5, 7, 7, 7;
        const pbd::Mat6d self = rear_coupling(at, 2.0, 3.0) + front_coupling(at, 5.0, 7.0);
        EXPECT_LT((self - j * w.asDiagonal() * j.transpose()).norm(), 1e-10);
        EXPECT_LT((rear_jacobian(at) - j.leftCols<6>()).norm(), 1e-15);
        EXPECT_LT((front_jacobian(at) - j.rightCols<6>()).norm(), 1e-15);
        const pbd::RodJointState next = evaluate(joint, b, a);
        const pbd::Mat6d through =
            front_jacobian(at) * w.tail<6>().asDiagonal() * rear_jacobian(next).transpose();
        EXPECT_LT((through_coupling(at, next, 5.0, 7.0) - through).norm(), 1e-10);
    }
}

// The chain's solver against a dense Cholesky of the same matrix. Condition number below 1e3 times
// double's 2e-16.
TEST(RodChain, SolutionMatchesDenseCholesky) {
    constexpr std::size_t blocks = 7;
    Random random(5);
    pbd::RodChain chain(blocks);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(42, 42);
    Eigen::VectorXd rhs(42);
    std::vector<pbd::Vec6d> solution(blocks);
    for (std::size_t i = 0; i < blocks; ++i) {
        const auto at = static_cast<Eigen::Index>(6 * i);
        const pbd::Mat6d m = pbd::Mat6d::NullaryExpr([&] { return double{random.normal()}; });
        chain.diagonal(i) = 30.0 * pbd::Mat6d::Identity() + m * m.transpose();
        dense.block<6, 6>(at, at) = chain.diagonal(i);
        if (i + 1 < blocks) {
            chain.right(i) = pbd::Mat6d::NullaryExpr([&] { return double{random.normal()}; });
            dense.block<6, 6>(at, at + 6) = chain.right(i);
            dense.block<6, 6>(at + 6, at) = chain.right(i).transpose();
        }
        solution[i] = pbd::Vec6d::NullaryExpr([&] { return double{random.normal()}; });
        rhs.segment<6>(at) = solution[i];
    }
    const Eigen::VectorXd expected = dense.llt().solve(rhs);
    chain.factorize();
    chain.solve(solution);
    for (std::size_t i = 0; i < blocks; ++i) {
        EXPECT_LT((solution[i] - expected.segment<6>(static_cast<Eigen::Index>(6 * i))).norm(), 1e-12);
    }
}

}  // namespace
}  // namespace eti
