// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/rod/rod_joint.hpp"

#include <cmath>

namespace eti::pbd {

Mat3d cross_matrix(const Vec3d& v) {
    Mat3d m;
    m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    return m;
}

Quatd unit_rotation(const Quatf& q) {
    return q.cast<double>().normalized();
}

Vec3d log_rotation(const Quatd& q) {
    const double sign = q.w() < 0.0 ? -1.0 : 1.0;
    const double sine = q.vec().norm();
    if (sine < 1e-12) {
        return 2.0 * sign * q.vec();
    }
    return q.vec() * (2.0 * sign * std::atan2(sine, sign * q.w()) / sine);
}

Quatd exp_rotation(const Vec3d& rotation) {
    const double angle = rotation.norm();
    // sin(a / 2) / a, as a series where the division would lose precision.
    const double factor = angle < 1e-4 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
    const Vec3d v = factor * rotation;
    return Quatd(std::cos(0.5 * angle), v.x(), v.y(), v.z()).normalized();
}

Mat3d inverse_right_jacobian(const Vec3d& theta) {
    const double squared = theta.squaredNorm();
    double factor = 1.0 / 12.0 + squared / 720.0;
    if (squared > 1e-4) {
        const double angle = std::sqrt(squared);
        factor = 1.0 / squared - 1.0 / (2.0 * angle * std::tan(0.5 * angle));
    }
    const Mat3d cross = cross_matrix(theta);
    return Mat3d::Identity() + 0.5 * cross + factor * cross * cross;
}

RodJointState evaluate(const RodJoint& joint, const RodSegment& a, const RodSegment& b) {
    RodJointState state;
    state.arm_a = a.to_front();
    state.arm_b = b.to_rear();
    state.gap = a.position + state.arm_a - b.position - state.arm_b;
    const Vec3d theta = log_rotation(Quatd(a.rotation.conjugate() * b.rotation));
    state.angle = theta - joint.rest;
    state.turn = inverse_right_jacobian(theta) * b.rotation.toRotationMatrix().transpose();
    return state;
}

namespace {

/// [r][s]^T of two cross-product matrices: (r . s) 1 - s r^T.
Mat3d cross_product(const Vec3d& r, const Vec3d& s) {
    return r.dot(s) * Mat3d::Identity() - s * r.transpose();
}

}  // namespace

Mat6d rear_jacobian(const RodJointState& joint) {
    Mat6d j;
    j << Mat3d::Identity(), -cross_matrix(joint.arm_a), Mat3d::Zero(), -joint.turn;
    return j;
}

Mat6d front_jacobian(const RodJointState& joint) {
    Mat6d j;
    j << -Mat3d::Identity(), cross_matrix(joint.arm_b), Mat3d::Zero(), joint.turn;
    return j;
}

namespace {

Mat6d coupling(const Vec3d& arm, const Mat3d& turn, double w, double i) {
    Mat6d m;
    m.topLeftCorner<3, 3>() = w * Mat3d::Identity() + i * cross_product(arm, arm);
    m.topRightCorner<3, 3>() = i * cross_matrix(arm) * turn.transpose();
    m.bottomLeftCorner<3, 3>() = m.topRightCorner<3, 3>().transpose();
    m.bottomRightCorner<3, 3>() = i * turn * turn.transpose();
    return m;
}

}  // namespace

Mat6d rear_coupling(const RodJointState& joint, double w, double i) {
    return coupling(joint.arm_a, joint.turn, w, i);
}

Mat6d front_coupling(const RodJointState& joint, double w, double i) {
    return coupling(joint.arm_b, joint.turn, w, i);
}

Mat6d through_coupling(const RodJointState& behind, const RodJointState& ahead, double w, double i) {
    Mat6d m;
    m.topLeftCorner<3, 3>() = -w * Mat3d::Identity() - i * cross_product(behind.arm_b, ahead.arm_a);
    m.topRightCorner<3, 3>() = -i * cross_matrix(behind.arm_b) * ahead.turn.transpose();
    m.bottomLeftCorner<3, 3>() = i * behind.turn * cross_matrix(ahead.arm_a);
    m.bottomRightCorner<3, 3>() = -i * behind.turn * ahead.turn.transpose();
    return m;
}

}  // namespace eti::pbd
