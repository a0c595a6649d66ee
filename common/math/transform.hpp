// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>

namespace eti {

using Vec3f = Eigen::Vector3f;
using Vec3d = Eigen::Vector3d;
using Mat3f = Eigen::Matrix3f;
using Quatf = Eigen::Quaternion<float, Eigen::DontAlign>;

/// A rigid transform x -> rotation * x + translation; lengths in metres.
struct RigidTransform {
    Quatf rotation = Quatf::Identity();
    Vec3f translation = Vec3f::Zero();

    [[nodiscard]] Vec3f operator*(const Vec3f& point) const { return rotation * point + translation; }

    [[nodiscard]] RigidTransform operator*(const RigidTransform& inner) const {
        return {(rotation * inner.rotation).normalized(), rotation * inner.translation + translation};
    }

    [[nodiscard]] RigidTransform inverse() const {
        const Quatf back = rotation.conjugate();
        return {back, back * (-translation)};
    }

    [[nodiscard]] static RigidTransform from(const Quatf& rotation, const Vec3f& translation) {
        return {rotation, translation};
    }

    /// Rotation by `angle` [rad] about the axis `direction` (unit) through `pivot`.
    [[nodiscard]] static RigidTransform about(const Vec3f& pivot, const Vec3f& direction, float angle) {
        const Quatf turn(Eigen::AngleAxisf(angle, direction));
        return {turn, pivot - turn * pivot};
    }
};

/// Interpolates from `a` (share 0) to `b` (share 1): rotation along the shortest arc, translation along a
/// line.
[[nodiscard]] inline RigidTransform interpolate(const RigidTransform& a, const RigidTransform& b,
                                                float share) {
    return {a.rotation.slerp(share, b.rotation), a.translation + share * (b.translation - a.translation)};
}

/// Coordinates at least this far [m] from the patient's gum are corrupt.
inline constexpr float max_coordinate = 10.0f;

/// Whether a point is finite and less than `max_distance` [m] from the origin.
[[nodiscard]] inline bool is_valid_point(const Vec3f& point, float max_distance = max_coordinate) {
    return point.norm() < max_distance;  // false for NaN
}

/// Whether a pose can be used: its origin is a valid point and its quaternion's norm is within 1e-3 of one.
/// Components rounded to three decimals change the norm by at most 1e-3, to 16 bits by 3e-5. A norm off by
/// 1e-3 scales lengths by 0.2 %, a blade of 0.1 m by 0.2 mm.
[[nodiscard]] inline bool is_valid_pose(const RigidTransform& pose, float max_distance = max_coordinate) {
    return is_valid_point(pose.translation, max_distance) && std::abs(pose.rotation.norm() - 1.0f) < 1e-3f;
}

/// Rotation vector (axis times angle, rad, angle in [0, pi]) of a unit quaternion.
[[nodiscard]] inline Vec3f rotation_vector(const Quatf& q) {
    const Quatf shorter = q.w() < 0 ? Quatf(-q.w(), -q.x(), -q.y(), -q.z()) : q;
    const float sine = shorter.vec().norm();
    if (sine < 1e-7f) {
        return 2.0f * shorter.vec();
    }
    return shorter.vec() * (2.0f * std::atan2(sine, shorter.w()) / sine);
}

/// Unit quaternion of a rotation vector [rad].
[[nodiscard]] inline Quatf quaternion_from(const Vec3f& rotation) {
    const float angle = rotation.norm();
    if (angle < 1e-7f) {
        return Quatf(1.0f, 0.5f * rotation.x(), 0.5f * rotation.y(), 0.5f * rotation.z()).normalized();
    }
    return Quatf(Eigen::AngleAxisf(angle, rotation / angle));
}

}  // namespace eti
