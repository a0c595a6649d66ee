// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/rod.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace eti::pbd {
namespace {

/// A linearised pass may not turn a segment further than this [rad]; larger answers are scaled down as
/// a whole (damped Newton), which only happens far from equilibrium: a tangled start, a jumping grip.
constexpr double largest_turn = 0.5;

/// Lengths behind and ahead of each segment's origin. The held one's origin is the grip; the others
/// have theirs in the middle. Both sides are cut so that segments are nearly equal.
struct Cut {
    std::size_t held = 0;
    double rear = 0.0;   ///< [m], length of the segments behind the held one
    double front = 0.0;  ///< [m], of those before it
};

Cut cut(double length, double from_tip, std::size_t count) {
    const double to_tip = std::clamp(from_tip, 0.0, length);
    const double to_rear = length - to_tip;
    const double even = length / static_cast<double>(count);
    Cut result;
    result.held = static_cast<std::size_t>(
        std::clamp(std::lround(to_rear / even - 0.5), 0L, static_cast<long>(count) - 1));
    // Half a held segment belongs to each side, or all that is left where no other segment is.
    result.rear = result.held == 0 ? 2.0 * to_rear : to_rear / (static_cast<double>(result.held) + 0.5);
    const std::size_t ahead = count - 1 - result.held;
    result.front = ahead == 0 ? 2.0 * to_tip : to_tip / (static_cast<double>(ahead) + 0.5);
    return result;
}

Quatd to_double(const Quatf& q) {
    return q.cast<double>().normalized();
}

Vec3d limited(const Vec3d& v, double limit) {
    const double size = v.norm();
    return size > limit ? Vec3d(v * (limit / size)) : v;
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
      max_speed_(double{settings.max_speed}) {
    lay_out(tube, settings);
    reset(grip);
}

void Rod::lay_out(const Tube& tube, const RodSettings& settings) {
    const double outer = 0.5 * double{tube.outer_diameter};
    const double inner = 0.5 * double{tube.inner_diameter};
    const double area = std::numbers::pi * (outer * outer - inner * inner);
    const Cut lengths = cut(double{tube.length}, double{tube.grip_from_tip}, segments_.size());
    held_ = lengths.held;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
        RodSegment& s = segments_[i];
        s.behind = 0.5 * (i <= held_ ? lengths.rear : lengths.front);
        s.ahead = 0.5 * (i < held_ ? lengths.rear : lengths.front);
        const double length = s.behind + s.ahead;
        const double mass =
            double{settings.density} * area * length + (i == 0 ? double{settings.connector_mass} : 0.0);
        if (i == held_ && settings.held) {
            held_mass_ = mass;
        } else {
            s.inverse_mass = 1.0 / mass;
            // Hollow cylinder about a transverse axis.
            s.inverse_inertia = 12.0 / (mass * (3.0 * (outer * outer + inner * inner) + length * length));
        }
    }
    const double bending = double{tube.bending_stiffness()};
    const double twist = bending / (1.0 + double{settings.poisson_ratio});
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const double length = segments_[j].ahead + segments_[j + 1].behind;
        joints_[j].bend_compliance = length * Vec3d(1.0 / bending, 1.0 / bending, 1.0 / twist);
        joints_[j].stretch_compliance = length / (double{tube.youngs_modulus} * area);
        // Turning z towards y is a negative rotation about x.
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
    segments_[held_].rotation = to_double(grip.rotation);
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

void Rod::predict(float dt, const Vec3f& gravity, const RigidTransform& grip) {
    dt_ = double{dt};
    gravity_ = gravity.cast<double>();
    std::copy(segments_.begin(), segments_.end(), previous_.begin());
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        angle_before_[j] = evaluate(joints_[j], segments_[j], segments_[j + 1]).angle;
    }
    for (RodSegment& s : segments_) {
        if (s.inverse_mass > 0.0) {
            s.position += dt_ * s.velocity;
            s.rotation = (exp_rotation(dt_ * s.angular_velocity) * s.rotation).normalized();
        }
    }
    if (held_mass_ > 0.0) {
        segments_[held_].position = grip.translation.cast<double>();
        segments_[held_].rotation = to_double(grip.rotation);
    }
    for (std::size_t i = 0; i < segments_.size(); ++i) {
        const bool free = segments_[i].inverse_mass > 0.0;
        target_[i] = {segments_[i].position + (free ? dt_ * dt_ : 0.0) * gravity_, segments_[i].rotation};
    }
}

void Rod::load(std::size_t segment, float along, const Vec3f& force) {
    const RodSegment& s = segments_[segment];
    const Vec3d impulse = dt_ * dt_ * force.cast<double>();
    Target& target = target_[segment];
    target.position += s.inverse_mass * impulse;
    const Vec3d turn = s.inverse_inertia * arm(segment, along, Vec3f::Zero()).cross(impulse);
    target.rotation = (exp_rotation(turn) * target.rotation).normalized();
}

void Rod::add_contacts(std::span<RodContact> contacts) {
    for (Response& response : response_) {
        response.touched = false;
    }
    for (const RodContact& contact : contacts) {
        Response& response = response_[contact.segment];
        if (!acts(contact) || segments_[contact.segment].inverse_mass == 0.0) {
            continue;
        }
        if (!response.touched) {
            response.touched = true;
            response.contacts = {};
        }
        add_contact(contact, arm(contact.segment, contact.along, contact.offset),
                    grip_stiffness(contact.segment), dt_, response.contacts);
    }
    for (std::size_t i = 0; i < segments_.size(); ++i) {
        Response& response = response_[i];
        if (!response.touched) {
            continue;
        }
        const RodSegment& s = segments_[i];
        Vec6d own;
        own << Vec3d::Constant(1.0 / s.inverse_mass), Vec3d::Constant(1.0 / s.inverse_inertia);
        Mat6d mass = response.contacts.mass;
        mass.diagonal() += own;
        response.inverse = mass.llt().solve(Mat6d::Identity());
        motion_[i] = response.inverse * (own.cwiseProduct(motion_[i]) + response.contacts.impulse);
    }
}

double Rod::grip_stiffness(std::size_t segment) const {
    const double inverse = segments_[segment].inverse_mass;
    return inverse > 0.0 ? 1.0 / (inverse * dt_ * dt_) : 0.0;
}

Vec6d Rod::answer(std::size_t segment, const Vec6d& impulse) const {
    if (response_[segment].touched) {
        return response_[segment].inverse * impulse;
    }
    Vec6d motion;
    motion << segments_[segment].inverse_mass * impulse.head<3>(),
        segments_[segment].inverse_inertia * impulse.tail<3>();
    return motion;
}

void Rod::assemble() {
    const double inverse_dt2 = 1.0 / (dt_ * dt_);
    // Viscosity g = retardation time / dt turns the constraint angle + compliance * moment into
    // (1 + g) angle - g angle_before + ...; divided by 1 + g the system stays symmetric.
    const double gamma = retardation_time_ / dt_;
    const double softening = 1.0 / (1.0 + gamma);
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const RodSegment& a = segments_[j];
        const RodSegment& b = segments_[j + 1];
        RodJointState& state = state_[j];
        state = evaluate(joints_[j], a, b);
        Mat6d& diagonal = chain_.diagonal(j);
        if (response_[j].touched) {
            const Mat6d jacobian = rear_jacobian(state);
            diagonal = jacobian * response_[j].inverse * jacobian.transpose();
        } else {
            diagonal = rear_coupling(state, a.inverse_mass, a.inverse_inertia);
        }
        if (response_[j + 1].touched) {
            const Mat6d jacobian = front_jacobian(state);
            diagonal += jacobian * response_[j + 1].inverse * jacobian.transpose();
        } else {
            diagonal += front_coupling(state, b.inverse_mass, b.inverse_inertia);
        }
        diagonal.diagonal().head<3>().array() += joints_[j].stretch_compliance * inverse_dt2;
        diagonal.diagonal().tail<3>() += softening * inverse_dt2 * joints_[j].bend_compliance;
        multiplier_[j] = -(rear_jacobian(state) * motion_[j] + front_jacobian(state) * motion_[j + 1]);
        multiplier_[j].head<3>() -= state.gap;
        multiplier_[j].tail<3>() += gamma * softening * angle_before_[j] - state.angle;
        if (j > 0) {
            chain_.right(j - 1) =
                response_[j].touched
                    ? Mat6d(front_jacobian(state_[j - 1]) * response_[j].inverse *
                            rear_jacobian(state).transpose())
                    : through_coupling(state_[j - 1], state, a.inverse_mass, a.inverse_inertia);
        }
    }
}

void Rod::solve(std::span<RodContact> contacts) {
    for (std::size_t i = 0; i < segments_.size(); ++i) {
        motion_[i] << target_[i].position - segments_[i].position,
            log_rotation(Quatd(target_[i].rotation * segments_[i].rotation.conjugate()));
    }
    add_contacts(contacts);
    assemble();
    chain_.factorize();
    chain_.solve(multiplier_);
    double widest = 0.0;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
        Vec6d impulse = Vec6d::Zero();
        if (i > 0) {
            impulse += front_jacobian(state_[i - 1]).transpose() * multiplier_[i - 1];
        }
        if (i < joints_.size()) {
            impulse += rear_jacobian(state_[i]).transpose() * multiplier_[i];
        }
        motion_[i] += answer(i, impulse);
        widest = std::max(widest, motion_[i].tail<3>().squaredNorm());
    }
    for (RodContact& contact : contacts) {
        contact.force = acts(contact)
                            ? contact_force(contact, arm(contact.segment, contact.along, contact.offset),
                                            grip_stiffness(contact.segment), motion_[contact.segment])
                            : Vec3f(Vec3f::Zero());
    }
    widest = std::sqrt(widest);
    const double scale = widest > largest_turn ? largest_turn / widest : 1.0;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
        if (segments_[i].inverse_mass > 0.0) {
            segments_[i].position += scale * motion_[i].head<3>();
            segments_[i].rotation =
                (exp_rotation(scale * motion_[i].tail<3>()) * segments_[i].rotation).normalized();
        }
    }
}

void Rod::finish() {
    const double damping = 1.0 / (1.0 + velocity_damping_ * dt_);
    for (std::size_t i = 0; i < segments_.size(); ++i) {
        RodSegment& s = segments_[i];
        const double keep = s.inverse_mass > 0.0 ? damping : 1.0;
        s.velocity = limited((s.position - previous_[i].position) * (keep / dt_), max_speed_);
        s.angular_velocity =
            limited(log_rotation(Quatd(s.rotation * previous_[i].rotation.conjugate())) * (keep / dt_),
                    max_speed_ / (s.behind + s.ahead));
    }
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
    s.rotation = to_double(pose.rotation);
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

float Rod::inverse_mass(std::size_t segment, float along, const Vec3f& offset, const Vec3f& direction) const {
    const RodSegment& s = segments_[segment];
    const Vec3d lever = arm(segment, along, offset).cross(direction.cast<double>());
    return static_cast<float>(s.inverse_mass + s.inverse_inertia * lever.squaredNorm());
}

void Rod::push(std::size_t segment, float along, const Vec3f& offset, const Vec3f& impulse) {
    RodSegment& s = segments_[segment];
    const Vec3d p = impulse.cast<double>();
    const Vec3d shift = s.inverse_mass * p;
    const Quatd turn =
        exp_rotation(limited(s.inverse_inertia * arm(segment, along, offset).cross(p), largest_turn));
    s.position += shift;
    s.rotation = (turn * s.rotation).normalized();
    target_[segment].position += shift;
    target_[segment].rotation = (turn * target_[segment].rotation).normalized();
}

Vec3f Rod::displace(std::size_t segment, float along, const Vec3f& offset, const Vec3f& displacement) {
    const float size = displacement.norm();
    if (size == 0.0f) {
        return Vec3f::Zero();
    }
    const float inverse = inverse_mass(segment, along, offset, displacement / size);
    if (inverse == 0.0f) {
        return Vec3f::Zero();
    }
    const Vec3f impulse = displacement / inverse;
    push(segment, along, offset, impulse);
    return impulse;
}

GripWrench Rod::grip_wrench() const {
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
