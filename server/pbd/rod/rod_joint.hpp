// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

namespace eti::pbd {

using Mat3d = Eigen::Matrix3d;
using Mat6d = Eigen::Matrix<double, 6, 6>;
using Vec6d = Eigen::Matrix<double, 6, 1>;
using Quatd = Eigen::Quaternion<double, Eigen::DontAlign>;

/// A rigid segment of the rod. Frame: origin on the centre line, +z towards the tip, +y to the concave side
/// of the manufactured curve. Double precision: stiffness over mass spans nine orders of magnitude in one
/// system.
struct RodSegment {
    Vec3d position = Vec3d::Zero();  ///< [m]
    Quatd rotation = Quatd::Identity();
    Vec3d velocity = Vec3d::Zero();          ///< [m/s]
    Vec3d angular_velocity = Vec3d::Zero();  ///< [rad/s]
    double behind = 0.0, ahead = 0.0;        ///< [m], from the origin to the ends
    double inverse_mass = 0.0;               ///< [1/kg]; 0: kinematic
    double inverse_inertia = 0.0;            ///< [1/(kg m^2)], equal about every axis

    [[nodiscard]] Vec3d to_rear() const { return rotation * Vec3d(0.0, 0.0, -behind); }
    [[nodiscard]] Vec3d to_front() const { return rotation * Vec3d(0.0, 0.0, ahead); }
};

/// Elastic joint between two neighbours, over the distance between their origins.
struct RodJoint {
    Vec3d rest = Vec3d::Zero();             ///< [rad], rotation vector from the rear to the front segment
    Vec3d bend_compliance = Vec3d::Zero();  ///< [rad/(N m)], about x, y (bending) and z (twist)
    double stretch_compliance = 0.0;        ///< [m/N], along all axes
};

/// Values and derivatives of a joint's six constraints: gap between the two ends (world axes) [m], then
/// rotation vector minus its rest value (front segment's axes) [rad]. For world displacements dx and
/// rotations w of rear (a) and front (b): gap' = dx_a + w_a x arm_a - dx_b - w_b x arm_b, angle' = turn (w_b
/// - w_a).
struct RodJointState {
    Vec3d gap = Vec3d::Zero();
    Vec3d angle = Vec3d::Zero();
    Vec3d arm_a = Vec3d::Zero();
    Vec3d arm_b = Vec3d::Zero();
    Mat3d turn = Mat3d::Identity();
};

[[nodiscard]] Mat3d cross_matrix(const Vec3d& v);

/// A rotation in double precision, renormalised.
[[nodiscard]] Quatd unit_rotation(const Quatf& q);

/// Rotation vector [rad] of a unit quaternion, length in [0, pi].
[[nodiscard]] Vec3d log_rotation(const Quatd& q);

/// Unit quaternion of a rotation vector [rad].
[[nodiscard]] Quatd exp_rotation(const Vec3d& rotation);

/// Derivative of the rotation vector `theta` of a rotation that is followed, in its own frame, by an
/// infinitesimal one: the inverse right Jacobian of SO(3) (Chirikjian 2012, eq. 10.86).
[[nodiscard]] Mat3d inverse_right_jacobian(const Vec3d& theta);

/// Zero-stretch and bend-twist constraints of a Cosserat rod (Kugelstadt & Schoemer 2016; Deul et al.
/// 2018, sec. 3) with the rotation vector in place of the quaternion's imaginary part, so that the
/// moment stays proportional to the angle at large bends.
[[nodiscard]] RodJointState evaluate(const RodJoint& joint, const RodSegment& a, const RodSegment& b);

/// Jacobian of the six constraint values by a segment's displacement and rotation, as the rear (a) and as the
/// front (b) of the joint.
[[nodiscard]] Mat6d rear_jacobian(const RodJointState& joint);
[[nodiscard]] Mat6d front_jacobian(const RodJointState& joint);

/// J W J^T for a segment with inverse mass w [1/kg] and inverse inertia i [1/(kg m^2)], in closed form: as
/// the rear of a joint, as its front, and as front of one joint and rear of the next.
[[nodiscard]] Mat6d rear_coupling(const RodJointState& joint, double w, double i);
[[nodiscard]] Mat6d front_coupling(const RodJointState& joint, double w, double i);
[[nodiscard]] Mat6d through_coupling(const RodJointState& behind, const RodJointState& ahead, double w,
                                     double i);

}  // namespace eti::pbd
