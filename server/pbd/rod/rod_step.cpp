// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The substep: prediction, Newton steps of chain and contacts, velocities.
#include <algorithm>
#include <cmath>

#include "server/pbd/rod/rod.hpp"

namespace eti::pbd {
namespace {

/// Maximum rotation [rad] of a segment per pass; larger steps are scaled down as a whole (damped Newton). It
/// is reached only far from equilibrium: a tangled start, a jumping grip.
constexpr double largest_turn = 0.5;

Vec3d limited_length(const Vec3d& v, double limit) {
    const double size = v.norm();
    return size > limit ? Vec3d(v * (limit / size)) : v;
}

}  // namespace

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
    grip_ = {grip.translation.cast<double>(), unit_rotation(grip.rotation)};
    if (held_mass_ > 0.0) {
        segments_[held_].position = grip.translation.cast<double>();
        segments_[held_].rotation = unit_rotation(grip.rotation);
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
        if (!is_active(contact) || segments_[contact.segment].inverse_mass == 0.0) {
            continue;
        }
        add_contact(contact, arm(contact.segment, contact.along, contact.offset),
                    grip_stiffness(contact.segment), dt_, touch(contact.segment).contacts);
    }
    if (hold_) {
        add_hold();
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

Rod::Response& Rod::touch(std::size_t segment) {
    Response& response = response_[segment];
    if (!response.touched) {
        response.touched = true;
        response.contacts = {};
    }
    return response;
}

namespace {

/// A spring that slips at `most`: force for a displacement, and its negative derivative.
struct Drawn {
    Vec3d force = Vec3d::Zero();
    Mat3d stiffness = Mat3d::Zero();
    bool slips = false;
};

Drawn drawn_by_grip(const Vec3d& displacement, double stiffness, double most) {
    const double length = displacement.norm();
    if (stiffness * length <= most) {
        return {stiffness * displacement, stiffness * Mat3d::Identity(), false};
    }
    const Vec3d along = displacement / length;
    return {most * along, most / length * (Mat3d::Identity() - along * along.transpose()), true};
}

}  // namespace

Rod::Held Rod::held_by_hold() const {
    const RodSegment& s = segments_[held_];
    const Drawn pull =
        drawn_by_grip(grip_.position - s.position, double{hold_->stiffness}, double{hold_->force});
    const Drawn turn = drawn_by_grip(log_rotation(Quatd(grip_.rotation * s.rotation.conjugate())),
                                     double{hold_->rotational_stiffness}, double{hold_->torque});
    Held held{pull.force, turn.force, pull.stiffness, turn.stiffness};
    if (pull.slips) {
        const double drag = double{hold_->drag} / dt_;
        held.force -= drag * (s.position - previous_[held_].position);
        held.stiffness += drag * Mat3d::Identity();
    }
    return held;
}

void Rod::add_hold() {
    const Held held = held_by_hold();
    RodContactSystem& system = touch(held_).contacts;
    system.mass.topLeftCorner<3, 3>() += dt_ * dt_ * held.stiffness;
    system.mass.bottomRightCorner<3, 3>() += dt_ * dt_ * held.rotational_stiffness;
    system.impulse.head<3>() += dt_ * dt_ * held.force;
    system.impulse.tail<3>() += dt_ * dt_ * held.torque;
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

namespace {

/// Reduces the fraction of a segment's motion until neither end exceeds the clearance.
void limit_to_clearance(float clearance, const Vec3d& way_of_front, const Vec3d& way_of_rear, double& share) {
    const double way = std::sqrt(std::max(way_of_front.squaredNorm(), way_of_rear.squaredNorm()));
    if (share * way > double{clearance}) {
        share = double{clearance} / way;
    }
}

}  // namespace

void Rod::limit_motion(std::span<const float> clearance) {
    double share = 1.0;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
        const RodSegment& now = segments_[i];
        const RodSegment& before = previous_[i];
        if (now.inverse_mass > 0.0) {
            limit_to_clearance(clearance[i],
                               now.position + now.to_front() - before.position - before.to_front(),
                               now.position + now.to_rear() - before.position - before.to_rear(), share);
        }
    }
    if (share == 1.0) {
        return;
    }
    for (std::size_t i = 0; i < segments_.size(); ++i) {
        RodSegment& s = segments_[i];
        if (s.inverse_mass > 0.0) {
            s.position = previous_[i].position + share * (s.position - previous_[i].position);
            s.rotation = previous_[i].rotation.slerp(share, s.rotation);
        }
    }
}

void Rod::solve(std::span<RodContact> contacts, std::span<const float> clearance) {
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
        contact.force = is_active(contact)
                            ? contact_force(contact, arm(contact.segment, contact.along, contact.offset),
                                            grip_stiffness(contact.segment), motion_[contact.segment])
                            : Vec3f(Vec3f::Zero());
    }
    widest = std::sqrt(widest);
    double scale = widest > largest_turn ? largest_turn / widest : 1.0;
    for (std::size_t i = 0; i < clearance.size(); ++i) {
        const RodSegment& s = segments_[i];
        const Vec3d shift = motion_[i].head<3>();
        const Vec3d turn = motion_[i].tail<3>();
        if (s.inverse_mass > 0.0) {
            limit_to_clearance(clearance[i], shift + turn.cross(s.to_front()),
                               shift + turn.cross(s.to_rear()), scale);
        }
    }
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
        s.velocity = limited_length((s.position - previous_[i].position) * (keep / dt_), max_speed_);
        s.angular_velocity =
            limited_length(log_rotation(Quatd(s.rotation * previous_[i].rotation.conjugate())) * (keep / dt_),
                           max_speed_ / (s.behind + s.ahead));
    }
}

}  // namespace eti::pbd
