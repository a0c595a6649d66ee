// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <string_view>

#include "common/math/transform.hpp"
#include "common/math/units.hpp"

namespace eti {

/// Distance by which a held tool is ahead of the pose that the patient allows, patient frame.
struct Overtravel {
    Vec3f translation = Vec3f::Zero();  ///< [m], of the tool's origin
    Vec3f rotation = Vec3f::Zero();     ///< [rad]
};

/// Limits of a hand moved by mouse and keys.
struct HandLimits {
    float speed = 0.12f;                 ///< [m/s], of tip and grip; a careful hand's
    float angular_speed = 1.5f;          ///< [rad/s]
    float max_target_distance = 30e-3f;  ///< [m]: maximum lead of the target over the hand
    float max_overtravel = 4e-3f;        ///< [m]: maximum lead over the proxy; 8 N of its spring
    float max_overtravel_angle = 0.04f;  ///< [rad], likewise
    float yield_time = 0.15f;            ///< [s], time constant of yielding beyond that
};

/// One row of the table of keys that move the hand while held.
struct HandKey {
    char32_t key;              ///< a lower-case letter
    std::string_view caption;  ///< key name, in ASCII
    std::string_view help;
    float lift = 0.0f;           ///< [m/s]
    Vec3f turn = Vec3f::Zero();  ///< [rad/s], about the tool's axes
};
[[nodiscard]] std::span<const HandKey> hand_keys();

inline constexpr char32_t home_key = U'z';       ///< returns the hand to its start
inline constexpr float slide_per_notch = 2e-3f;  ///< [m], by a notch of the wheel

/// A tool held by a hand that mouse and keys move: a target pose, and the hand's pose, which follows at
/// limited speed. Where the patient blocks the tool, both stop, so that the hand retreats as soon as it is
/// moved back. Tool frames as in common/model/tools/tools.hpp.
class HeldTool {
  public:
    /// `length` [m] from the frame's origin along the tool to its tip, `curvature` [1/m] towards +y.
    HeldTool(float length, float curvature, const RigidTransform& start, const HandLimits& limits = {});

    /// Translates the tool by `way` [m].
    void move(const Vec3f& way);
    /// Rotates the tool about its tip so that its origin moves by `way` [m], as far as a rotation can.
    void swing_grip(const Vec3f& way);
    /// Rotates the tool about `pivot` so that its tip moves by `way` [m], likewise.
    void swing_tip(const Vec3f& pivot, const Vec3f& way);
    /// Slides along the tool [m], towards its tip; a curved tool follows its arc.
    void slide(float length);
    /// Moves along the handle [m].
    void lift(float length);
    /// Rotates about the tool's own axes [rad], at its tip.
    void turn(const Vec3f& angles);
    /// Lifts and turns as a key does that is held for `dt` [s].
    void hold(const HandKey& key, float dt);
    /// Returns to the start along a straight path.
    void go_home() { target_ = home_; }

    /// Moves the pose towards the target for `dt` [s].
    void advance(float dt, const Overtravel& overtravel);

    [[nodiscard]] const RigidTransform& pose() const { return pose_; }
    [[nodiscard]] const RigidTransform& target() const { return target_; }
    [[nodiscard]] Vec3f tip() const { return pose_ * tip_; }
    /// Arc length [m] from the origin to the point of the target tool nearest to `point`.
    [[nodiscard]] float arc_length_to(const Vec3f& point) const;
    /// The point [m] at that arc length.
    [[nodiscard]] Vec3f point_at(float length) const;
    [[nodiscard]] float length() const { return length_; }

  private:
    void swing(const Vec3f& pivot, const Vec3f& arm, const Vec3f& way);
    void limit_overtravel(float dt, const Overtravel& overtravel);
    /// [m] distance that tip or origin still has to move.
    [[nodiscard]] float remaining_distance() const;
    /// The pose a fraction `share` of the way to the target, with the tip on a straight line.
    [[nodiscard]] RigidTransform interpolated_to_target(float share) const;

    float length_, curvature_;
    HandLimits limits_;
    Vec3f tip_;  // tool frame
    RigidTransform home_, pose_, target_;
};

}  // namespace eti
