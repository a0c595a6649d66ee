// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/device/held_tool.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/tools/tools.hpp"

namespace eti {
namespace {

constexpr float lifting = 15e-3f;          // [m/s]
constexpr float turning = 25.0f * degree;  // [rad/s]

const std::array keys{
    HandKey{U'w', "w", "lift along the handle", lifting},
    HandKey{U'q', "q", "lower", -lifting},
    HandKey{U'g', "g", "tip up", 0.0f, {-turning, 0.0f, 0.0f}},
    HandKey{U'f', "f", "tip down", 0.0f, {turning, 0.0f, 0.0f}},
    HandKey{U'a', "a", "tip to the left", 0.0f, {0.0f, turning, 0.0f}},
    HandKey{U'd', "d", "tip to the right", 0.0f, {0.0f, -turning, 0.0f}},
    HandKey{U't', "t", "roll to the left", 0.0f, {0.0f, 0.0f, -turning}},
    HandKey{U'y', "y", "roll to the right", 0.0f, {0.0f, 0.0f, turning}},
};

// Limits `gap` in the direction of `overtravel`: half of `most` is free, beyond that the step decreases to
// zero.
Vec3f limited_step(const Vec3f& gap, const Vec3f& overtravel, float most) {
    const float size = overtravel.norm();
    const float free = std::clamp((most - size) / (0.5f * most), 0.0f, 1.0f);
    if (free >= 1.0f) {
        return gap;
    }
    const Vec3f direction = overtravel / size;
    const float pressing = std::max(0.0f, gap.dot(direction));
    return gap - (1.0f - free) * pressing * direction;
}

// Step by which a hand too far ahead retreats in a fraction `share` of its yield time.
Vec3f recovery_step(const Vec3f& overtravel, float most, float share) {
    const float size = overtravel.norm();
    return size > most ? Vec3f(-(size - most) / size * share * overtravel) : Vec3f(Vec3f::Zero());
}

}  // namespace

std::span<const HandKey> hand_keys() {
    return keys;
}

HeldTool::HeldTool(float length, float curvature, const RigidTransform& start, const HandLimits& limits)
    : length_(length),
      curvature_(curvature),
      limits_(limits),
      tip_(along_arc(curvature, length).translation),
      home_(start),
      pose_(start),
      target_(start) {}

void HeldTool::move(const Vec3f& way) {
    target_.translation += way;
}

void HeldTool::swing(const Vec3f& pivot, const Vec3f& arm, const Vec3f& way) {
    const Quatf turn = quaternion_from(arm.cross(way) / std::max(arm.squaredNorm(), 1e-6f));
    target_ = RigidTransform{turn, pivot - turn * pivot} * target_;
}

void HeldTool::swing_grip(const Vec3f& way) {
    const Vec3f tip = target_ * tip_;
    swing(tip, target_.translation - tip, way);
}

void HeldTool::swing_tip(const Vec3f& pivot, const Vec3f& way) {
    swing(pivot, target_ * tip_ - pivot, way);
}

void HeldTool::slide(float length) {
    target_ = target_ * along_arc(curvature_, length);
}

void HeldTool::lift(float length) {
    target_.translation += length * (target_.rotation * Vec3f::UnitY());
}

void HeldTool::turn(const Vec3f& angles) {
    const Vec3f tip = target_ * tip_;
    target_.rotation = (target_.rotation * quaternion_from(angles)).normalized();
    target_.translation = tip - target_.rotation * tip_;
}

void HeldTool::hold(const HandKey& key, float dt) {
    lift(key.lift * dt);
    turn(key.turn * dt);
}

float HeldTool::arc_length_to(const Vec3f& point) const {
    return eti::arc_length_to(curvature_, target_.inverse() * point);
}

Vec3f HeldTool::point_at(float length) const {
    return target_ * along_arc(curvature_, length).translation;
}

void HeldTool::limit_overtravel(float dt, const Overtravel& overtravel) {
    const float share = std::min(1.0f, dt / limits_.yield_time);
    pose_.translation += recovery_step(overtravel.translation, limits_.max_overtravel, share);
    pose_.rotation =
        (quaternion_from(recovery_step(overtravel.rotation, limits_.max_overtravel_angle, share)) *
         pose_.rotation)
            .normalized();
    const Vec3f way =
        limited_step(target_.translation - pose_.translation, overtravel.translation, limits_.max_overtravel);
    const Vec3f turn = limited_step(rotation_vector(target_.rotation * pose_.rotation.conjugate()),
                                    overtravel.rotation, limits_.max_overtravel_angle);
    target_ = {(quaternion_from(turn) * pose_.rotation).normalized(), pose_.translation + way};
    target_ = interpolated_to_target(
        std::min(1.0f, limits_.max_target_distance / std::max(remaining_distance(), 1e-9f)));
}

float HeldTool::remaining_distance() const {
    return std::max((target_ * tip_ - pose_ * tip_).norm(), (target_.translation - pose_.translation).norm());
}

RigidTransform HeldTool::interpolated_to_target(float share) const {
    if (share >= 1.0f) {
        return target_;
    }
    const Quatf rotation = pose_.rotation.slerp(share, target_.rotation).normalized();
    const Vec3f tip = pose_ * tip_ + share * (target_ * tip_ - pose_ * tip_);
    return {rotation, tip - rotation * tip_};
}

void HeldTool::advance(float dt, const Overtravel& overtravel) {
    if (!(dt > 0.0f) || !overtravel.translation.allFinite() || !overtravel.rotation.allFinite()) {
        return;
    }
    limit_overtravel(dt, overtravel);
    const float angle = rotation_vector(target_.rotation * pose_.rotation.conjugate()).norm();
    pose_ = interpolated_to_target(std::min({1.0f, limits_.speed * dt / std::max(remaining_distance(), 1e-9f),
                                             limits_.angular_speed * dt / std::max(angle, 1e-9f)}));
}

}  // namespace eti
