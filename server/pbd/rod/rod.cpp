// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/rod/rod.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace eti::pbd {
namespace {

/// Lengths behind and ahead of each segment's origin. The origin of the held segment is the grip; that of the
/// others is their middle. Both sides are divided so that segments are nearly equal.
struct Cut {
    std::size_t held = 0;
    double rear = 0.0;   ///< [m], length of the segments behind the held one
    double front = 0.0;  ///< [m], of those ahead of it
};

Cut cut(double length, double from_tip, std::size_t count) {
    const double to_tip = std::clamp(from_tip, 0.0, length);
    const double to_rear = length - to_tip;
    const double even = length / static_cast<double>(count);
    Cut result;
    result.held = static_cast<std::size_t>(
        std::clamp(std::lround(to_rear / even - 0.5), 0L, static_cast<long>(count) - 1));
    // Half of the held segment belongs to each side, or all of the rest on a side without other segments.
    result.rear = result.held == 0 ? 2.0 * to_rear : to_rear / (static_cast<double>(result.held) + 0.5);
    const std::size_t ahead = count - 1 - result.held;
    result.front = ahead == 0 ? 2.0 * to_tip : to_tip / (static_cast<double>(ahead) + 0.5);
    return result;
}

/// Cross-section [m^2] of the tube's wall.
double section(const Tube& tube) {
    const double outer = 0.5 * double{tube.outer_diameter};
    const double inner = 0.5 * double{tube.inner_diameter};
    return std::numbers::pi * (outer * outer - inner * inner);
}

}  // namespace

Rod::Rod(const Tube& tube, const RodSettings& settings, const RigidTransform& grip)
    : segments_(static_cast<std::size_t>(std::max(settings.segments, 2))),
      joints_(segments_.size() - 1),
      state_(joints_.size()),
      angle_before_(joints_.size(), Vec3d::Zero()),
      target_(segments_.size()),
      multiplier_(joints_.size(), Vec6d::Zero()),
      motion_(segments_.size(), Vec6d::Zero()),
      response_(segments_.size()),
      chain_(joints_.size()),
      radius_(0.5f * tube.outer_diameter),
      retardation_time_(double{settings.retardation_time}),
      velocity_damping_(double{settings.velocity_damping}),
      poisson_ratio_(double{settings.poisson_ratio}),
      max_speed_(double{settings.max_speed}) {
    if (settings.held) {
        hold_ = settings.hold;
    }
    lay_out(tube, settings);
    reset(grip);
}

void Rod::lay_out(const Tube& tube, const RodSettings& settings) {
    const double outer = 0.5 * double{tube.outer_diameter};
    const double inner = 0.5 * double{tube.inner_diameter};
    const double area = section(tube);
    const Cut lengths = cut(double{tube.length}, double{tube.grip_from_tip}, segments_.size());
    held_ = lengths.held;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
        RodSegment& s = segments_[i];
        s.behind = 0.5 * (i <= held_ ? lengths.rear : lengths.front);
        s.ahead = 0.5 * (i < held_ ? lengths.rear : lengths.front);
        const double length = s.behind + s.ahead;
        const double mass =
            double{settings.density} * area * length + (i == 0 ? double{settings.connector_mass} : 0.0);
        if (i == held_ && settings.held && !settings.hold) {
            held_mass_ = mass;
        } else {
            s.inverse_mass = 1.0 / mass;
            // Hollow cylinder about a transverse axis.
            s.inverse_inertia = 12.0 / (mass * (3.0 * (outer * outer + inner * inner) + length * length));
        }
    }
    set_material(tube);
}

void Rod::set_material(const Tube& tube) {
    const double area = section(tube);
    const double bending = double{tube.bending_stiffness()};
    const double twist = bending / (1.0 + poisson_ratio_);
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const double length = segments_[j].ahead + segments_[j + 1].behind;
        joints_[j].bend_compliance = length * Vec3d(1.0 / bending, 1.0 / bending, 1.0 / twist);
        joints_[j].stretch_compliance = length / (double{tube.youngs_modulus} * area);
        // Rotating z towards y is a negative rotation about x.
        const double curvature = tube.curve_radius > 0.0f ? 1.0 / double{tube.curve_radius} : 0.0;
        joints_[j].rest = Vec3d(-length * curvature, 0.0, 0.0);
    }
}

void Rod::reset(const RigidTransform& grip) {
    for (RodSegment& s : segments_) {
        s.velocity.setZero();
        s.angular_velocity.setZero();
    }
    segments_[held_].position = grip.translation.cast<double>();
    segments_[held_].rotation = unit_rotation(grip.rotation);
    grip_ = {segments_[held_].position, segments_[held_].rotation};
    for (std::size_t i = held_ + 1; i < segments_.size(); ++i) {
        segments_[i].rotation = (segments_[i - 1].rotation * exp_rotation(joints_[i - 1].rest)).normalized();
        segments_[i].position =
            segments_[i - 1].position + segments_[i - 1].to_front() - segments_[i].to_rear();
    }
    for (std::size_t i = held_; i-- > 0;) {
        segments_[i].rotation = (segments_[i + 1].rotation * exp_rotation(-joints_[i].rest)).normalized();
        segments_[i].position =
            segments_[i + 1].position + segments_[i + 1].to_rear() - segments_[i].to_front();
    }
    previous_ = segments_;
    std::fill(multiplier_.begin(), multiplier_.end(), Vec6d::Zero());
}

float Rod::length(std::size_t segment) const {
    return static_cast<float>(segments_[segment].behind + segments_[segment].ahead);
}

RigidTransform Rod::pose(std::size_t segment) const {
    return {segments_[segment].rotation.cast<float>(), segments_[segment].position.cast<float>()};
}

void Rod::place(std::size_t segment, const RigidTransform& pose) {
    RodSegment& s = segments_[segment];
    s.position = pose.translation.cast<double>();
    s.rotation = unit_rotation(pose.rotation);
    s.velocity.setZero();
    s.angular_velocity.setZero();
}

Vec3d Rod::arm(std::size_t segment, float along, const Vec3f& offset) const {
    const RodSegment& s = segments_[segment];
    return s.rotation * Vec3d(0.0, 0.0, double{along} * (s.behind + s.ahead) - s.behind) +
           offset.cast<double>();
}

Vec3f Rod::point(std::size_t segment, float along) const {
    return (segments_[segment].position + arm(segment, along, Vec3f::Zero())).cast<float>();
}

Vec3f Rod::previous_point(std::size_t segment, float along) const {
    const RodSegment& s = previous_[segment];
    const Vec3d local(0.0, 0.0, double{along} * (s.behind + s.ahead) - s.behind);
    return (s.position + s.rotation * local).cast<float>();
}

void Rod::nodes(std::span<Vec3f> out) const {
    assert(out.size() == segments_.size() + 1);
    out.front() = point(0, 0.0f);
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        out[j + 1] = 0.5f * (point(j, 1.0f) + point(j + 1, 0.0f));
    }
    out.back() = tip();
}

GripWrench Rod::grip_wrench() const {
    if (hold_) {
        const Held held = held_by_hold();
        return {(-held.force).cast<float>(), (-held.torque).cast<float>()};
    }
    Vec3d force = Vec3d::Zero();
    Vec3d torque = Vec3d::Zero();
    if (held_ > 0) {
        const Vec6d& m = multiplier_[held_ - 1];
        const RodJointState& joint = state_[held_ - 1];
        force -= m.head<3>();
        torque += joint.turn.transpose() * m.tail<3>() - joint.arm_b.cross(Vec3d(m.head<3>()));
    }
    if (held_ < joints_.size()) {
        const Vec6d& m = multiplier_[held_];
        const RodJointState& joint = state_[held_];
        force += m.head<3>();
        torque += joint.arm_a.cross(Vec3d(m.head<3>())) - joint.turn.transpose() * m.tail<3>();
    }
    const double inverse_dt2 = 1.0 / (dt_ * dt_);
    const RodSegment& s = segments_[held_];
    const Vec3d weight = held_mass_ * gravity_;
    const Vec3d centre = s.rotation * Vec3d(0.0, 0.0, 0.5 * (s.ahead - s.behind));
    return {(inverse_dt2 * force + weight).cast<float>(),
            (inverse_dt2 * torque + centre.cross(weight)).cast<float>()};
}

double Rod::energy() const {
    double sum = 0.0;
    for (const RodSegment& s : segments_) {
        if (s.inverse_mass > 0.0) {
            sum += 0.5 * s.velocity.squaredNorm() / s.inverse_mass +
                   0.5 * s.angular_velocity.squaredNorm() / s.inverse_inertia -
                   gravity_.dot(s.position) / s.inverse_mass;
        }
    }
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const RodJointState now = evaluate(joints_[j], segments_[j], segments_[j + 1]);
        sum += 0.5 * now.angle.cwiseAbs2().cwiseQuotient(joints_[j].bend_compliance).sum() +
               0.5 * now.gap.squaredNorm() / joints_[j].stretch_compliance;
    }
    return sum;
}

}  // namespace eti::pbd
