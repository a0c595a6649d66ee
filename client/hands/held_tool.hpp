// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"
#include "common/math/units.hpp"

namespace eti::client {

/// How far a tool in the hand is ahead of where the patient lets it be, in the patient frame.
struct Lead {
    Vec3f way = Vec3f::Zero();   ///< [m], of the tool's origin
    Vec3f turn = Vec3f::Zero();  ///< [rad]
};

/// Bounds of a hand that mouse and keys move.
struct HandLimits {
    float speed = 0.12f;          ///< [m/s], of tip and grip; a careful hand's
    float turning = 1.5f;         ///< [rad/s]
    float ahead = 30e-3f;         ///< [m]: what was asked for runs no farther ahead of the hand
    float lead = 4e-3f;           ///< [m]: no farther does the hand press on; 8 N of the proxy's spring
    float lead_turn = 0.04f;      ///< [rad], likewise
    float give_way_time = 0.15f;  ///< [s], in which it yields where it is farther ahead than that
};

/// A tool in a hand that mouse and keys move: what was asked for, and where the hand is, which follows no
/// faster than a hand goes. It stops where the patient holds the tool back, and what was asked for
/// with it: the hand comes back as soon as it is moved back. Tool frames as in common/model/tools.hpp.
class HeldTool {
  public:
    /// `length` [m] from the frame's origin along the tool to its tip, `curvature` [1/m] towards +y.
    HeldTool(float length, float curvature, const RigidTransform& start, const HandLimits& limits = {});

    /// Moves all of the tool by `way` [m].
    void move(const Vec3f& way);
    /// Turns the tool about its tip, so that its origin goes by `way` [m], as far as a turn takes it there.
    void swing_grip(const Vec3f& way);
    /// Turns the tool about `pivot`, so that its tip goes by `way` [m], likewise.
    void swing_tip(const Vec3f& pivot, const Vec3f& way);
    /// Along the tool [m], towards its tip; a curved one goes along its arc.
    void slide(float length);
    /// Along the handle [m].
    void lift(float length);
    /// About the tool's own axes [rad], at its tip.
    void turn(const Vec3f& angles);
    /// Back to the start, on the straight way.
    void go_home() { wanted_ = home_; }
    /// To another start, at once.
    void put(const RigidTransform& pose) { pose_ = wanted_ = home_ = pose; }

    /// Follows what was asked for by `dt` [s].
    void advance(float dt, const Lead& lead);

    [[nodiscard]] const RigidTransform& pose() const { return pose_; }
    [[nodiscard]] const RigidTransform& wanted() const { return wanted_; }
    [[nodiscard]] Vec3f tip() const { return pose_ * tip_; }
    /// Where the tool, as wanted, is nearest to `point`: [m] along it from its origin.
    [[nodiscard]] float length_until(const Vec3f& point) const;
    /// That place [m].
    [[nodiscard]] Vec3f along(float length) const;
    [[nodiscard]] float length() const { return length_; }

  private:
    void swing(const Vec3f& pivot, const Vec3f& arm, const Vec3f& way);
    void hold_back(float dt, const Lead& lead);
    /// [m], that tip or origin has to go yet.
    [[nodiscard]] float path() const;
    /// So much of the way there, the tip on a straight line.
    [[nodiscard]] RigidTransform towards_wanted(float share) const;

    float length_, curvature_;
    HandLimits limits_;
    Vec3f tip_;  // tool frame
    RigidTransform home_, pose_, wanted_;
};

}  // namespace eti::client
