// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/skeleton/yielding_skeleton.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/landmark.hpp"

namespace eti::scene {

namespace {

using Columns = pbd::YieldingBodies::Columns;

constexpr auto skull = static_cast<std::size_t>(patient::Bone::skull);
constexpr auto mandible = static_cast<std::size_t>(patient::Bone::mandible);

// At term [m]: the hyoid's body lies so far in front of and below the epiglottis' base, and its motion ends
// so far from it.
constexpr float hyoid_forward_of_base = 7e-3f;
constexpr float hyoid_below_base = 2.5e-3f;
constexpr float hyoid_reach = 18e-3f;
constexpr float thyroid_wall = 3.5e-3f;  // at term [m], in front of the anterior commissure
constexpr float gravity = 9.81f;         // [m/s^2]

JointProperties scaled(JointProperties p, float weight) {
    const float s = std::cbrt(weight / 3.5f);
    const float s3 = s * s * s;
    for (float* mass : {&p.head_mass, &p.jaw_mass, &p.hyoid_mass}) {
        *mass *= s3;
    }
    for (float* inertia : {&p.head_inertia, &p.jaw_inertia}) {
        *inertia *= s3 * s * s;
    }
    for (float* torsion : {&p.neck_flexion, &p.neck_extension, &p.neck_stop, &p.jaw_opening, &p.jaw_stop}) {
        *torsion *= s3;
    }
    for (float* spring : {&p.neck_lift, &p.jaw_slide, &p.jaw_slide_stop, &p.hyoid_sideways, &p.hyoid_forward,
                          &p.hyoid_stop}) {
        *spring *= s;
    }
    p.jaw_gape *= s;
    p.occiput *= s;
    p.jaw_slide_range *= s;
    p.hyoid_range *= s;
    return p;
}

}  // namespace

YieldingSkeleton::YieldingSkeleton(const patient::Patient& patient, const JointProperties& at_term)
    : joints_(patient.skeleton), properties_(scaled(at_term, patient.weight)) {
    const float size = std::cbrt(patient.weight / 3.5f);
    hyoid_ = patient::rest_of(patient, Landmark::epiglottis_base) -
             size * Vec3f(0.0f, hyoid_forward_of_base, hyoid_below_base);
    reach_ = size * hyoid_reach;
    thyroid_ = patient::rest_of(patient, Landmark::glottis_anterior) - size * Vec3f(0.0f, thyroid_wall, 0.0f);
    thyroid_carrier_ = {{1.0f, 0.0f, 0.0f}, hyoid_share(thyroid_)};
    // Gape over opening: the lower gum turns about the jaw's joint and slides.
    const Vec3f upper = patient::rest_of(patient, Landmark::upper_gum);
    const Vec3f lower = patient::rest_of(patient, Landmark::lower_gum);
    const auto gape = [&](float opening) {
        const patient::BonePoses bones = patient::pose_bones(joints_, {0.0f, opening, 0.0f});
        return (bones[mandible] * lower - upper).norm();
    };
    const float arm_of_gum = (lower - joints_.jaw_joint).norm();
    closed_ = -(lower - upper).norm() / arm_of_gum;
    for (float opening = 0.0f; opening <= max_jaw_opening; opening += 0.1f * degree) {
        widest_opening_ = opening;
        if (gape(opening) >= properties_.jaw_gape) {
            break;
        }
    }
    reset({});
}

void YieldingSkeleton::reset(const patient::Posture& posture) {
    for (Vector* state : {&offset_, &velocity_, &muscle_rest_}) {
        state->setZero();
    }
    recovers_ = false;
    unload();
    follow(posture);
}

void YieldingSkeleton::follow(const patient::Posture& posture) {
    posture_ = reachable(posture);
    place();
}

patient::Posture YieldingSkeleton::reachable(patient::Posture posture) const {
    posture.head_elevation = std::clamp(posture.head_elevation, 0.0f, max_head_elevation);
    posture.jaw_opening = std::clamp(posture.jaw_opening, 0.0f, widest_opening_);
    return posture;
}

void YieldingSkeleton::place() {
    poses_ =
        patient::pose_joints(joints_, {head_elevation(), opening(), offset_[head_lift], offset_[jaw_slide]});
}

float YieldingSkeleton::hyoid_share(const Vec3f& rest) const {
    const float x = 1.0f - (rest - hyoid_).norm() / reach_;
    if (x <= 0.0f) {
        return 0.0f;
    }
    // 1 within a third of the reach.
    const float t = std::min(1.0f, 1.5f * x);
    return t * t * (3.0f - 2.0f * t);
}

Vec3f YieldingSkeleton::pose_point(const Vec3f& rest, const Carrier& carrier) const {
    Vec3f posed = patient::pose_point(rest, carrier.bones, poses_);
    if (carrier.hyoid > 0.0f) {
        posed += carrier.hyoid * offset_.segment<3>(hyoid_left);
    }
    return posed;
}

Columns YieldingSkeleton::columns(const Vec3f& rest, const Carrier& carrier) const {
    const float on_skull = carrier.bones[skull];
    const float on_mandible = carrier.bones[mandible];
    const Vec3f neck = poses_[skull] * joints_.neck_joint;
    const Vec3f moved = on_skull * (poses_[skull] * rest) + on_mandible * (poses_[mandible] * rest);
    return columns_about(moved - (on_skull + on_mandible) * neck, poses_[mandible] * rest, carrier);
}

Columns YieldingSkeleton::columns_at(const Vec3f& posed, const Carrier& carrier) const {
    const float on_head = carrier.bones[skull] + carrier.bones[mandible];
    return columns_about(on_head * (posed - poses_[skull] * joints_.neck_joint), posed, carrier);
}

Columns YieldingSkeleton::columns_about(const Vec3f& neck_arm, const Vec3f& on_jaw,
                                        const Carrier& carrier) const {
    Columns out;
    out.fill(Eigen::Vector4f::Zero());
    const float on_mandible = carrier.bones[mandible];
    const Vec3f forward = poses_[skull].rotation * Vec3f(0.0f, -1.0f, 0.0f);
    out[head_extension].head<3>() = -Vec3f::UnitX().cross(neck_arm);
    out[head_lift].y() = -(carrier.bones[skull] + on_mandible);
    out[jaw_opening].head<3>() =
        on_mandible * (Vec3f::UnitX().cross(on_jaw - poses_[mandible] * joints_.jaw_joint) +
                       joints_.jaw_slide_per_radian * forward);
    out[jaw_slide].head<3>() = on_mandible * forward;
    out[hyoid_left].x() = carrier.hyoid;
    out[hyoid_back].y() = carrier.hyoid;
    out[hyoid_up].z() = carrier.hyoid;
    return out;
}

void YieldingSkeleton::unload() {
    load_.setZero();
    contact_stiffness_.setZero();
}

void YieldingSkeleton::add_load(const Bodies::Columns& at, const Vec3f& force) {
    Eigen::Vector4f wide = Eigen::Vector4f::Zero();
    wide.head<3>() = force;
    Bodies::add_transposed(at, wide, load_);
}

void YieldingSkeleton::add_contact(const Bodies::Columns& at, const Vec3f& force, const Vec3f& normal,
                                   float stiffness) {
    add_load(at, force);
    Vector along = Vector::Zero();
    Eigen::Vector4f wide = Eigen::Vector4f::Zero();
    wide.head<3>() = normal;
    Bodies::add_transposed(at, wide, along);
    contact_stiffness_ += stiffness * along * along.transpose();
}

std::array<YieldingSkeleton::Restoring, YieldingSkeleton::Bodies::coordinates> YieldingSkeleton::restoring()
    const {
    const JointProperties& p = properties_;
    std::array<Restoring, Bodies::coordinates> out;
    const auto spring = [&](Coordinate c, float relaxed, float held = 0.0f) {
        const float passive = passive_ * relaxed;
        out[c] = {-(passive + held) * offset_[c], passive + held, passive};
    };
    /// Acts beyond a limit, in the direction `sign`.
    const auto stop = [&](Coordinate c, float beyond, float sign, float stiffness) {
        if (beyond > 0.0f) {
            out[c].force -= sign * stiffness * beyond;
            out[c].stiffness += stiffness;
        }
    };
    const float extension = offset_[head_extension];
    const float held_head = posture_.head_elevation > 0.0f ? p.hand_on_head : 0.0f;
    spring(head_extension, extension > 0.0f ? p.neck_extension : p.neck_flexion, held_head);
    stop(head_extension, std::abs(extension) - p.neck_range, extension > 0.0f ? 1.0f : -1.0f, p.neck_stop);

    spring(head_lift, p.neck_lift);

    const float held_jaw = posture_.jaw_opening > 0.0f ? p.hand_on_jaw : 0.0f;
    spring(jaw_opening, p.jaw_opening, held_jaw);
    stop(jaw_opening, opening() - widest_opening_, 1.0f, p.jaw_stop);
    stop(jaw_opening, closed_ - opening(), -1.0f, p.jaw_stop);
    spring(jaw_slide, p.jaw_slide);
    stop(jaw_slide, offset_[jaw_slide] - p.jaw_slide_range, 1.0f, p.jaw_slide_stop);
    stop(jaw_slide, -offset_[jaw_slide], -1.0f, p.jaw_slide_stop);

    spring(hyoid_left, p.hyoid_sideways);
    spring(hyoid_back, p.hyoid_forward);
    spring(hyoid_up, p.hyoid_forward);
    for (const Coordinate c : {hyoid_left, hyoid_back, hyoid_up}) {
        stop(c, std::abs(offset_[c]) - p.hyoid_range, offset_[c] > 0.0f ? 1.0f : -1.0f, p.hyoid_stop);
    }
    return out;
}

// The mattress bears the head's weight at rest. As the occiput rises it unloads, and then the whole weight
// hangs on what lifts the head.
YieldingSkeleton::Restoring YieldingSkeleton::table() const {
    const float risen = offset_[head_lift] - properties_.occiput * offset_[head_extension];
    const float weight = properties_.head_mass * gravity;
    if (properties_.mattress * risen > weight) {
        return {-weight, 0.0f};
    }
    return {-properties_.mattress * risen, properties_.mattress};
}

void YieldingSkeleton::write(Bodies& bodies, float dt) const {
    const JointProperties& p = properties_;
    const std::array<float, Bodies::coordinates> inertia = {
        p.head_inertia, p.head_mass, p.jaw_inertia, p.jaw_mass, p.hyoid_mass, p.hyoid_mass, p.hyoid_mass};
    bodies.matrix = contact_stiffness_;
    bodies.force = load_;
    // The relaxing branch's rest at the end of the step: kept of what it was, and what follows the offset.
    const float kept = 1.0f - relaxation_.rate(dt, recovers_);
    const float follows = recovers_ ? 0.0f : 1.0f - kept;
    const auto springs = restoring();
    for (std::size_t n = 0; n < Bodies::coordinates; ++n) {
        const auto c = static_cast<Eigen::Index>(n);
        const float stiffness = springs[n].stiffness;
        const float relaxing = relaxation_.share * springs[n].passive;
        bodies.matrix(c, c) +=
            inertia[n] / (dt * dt) + p.damping_time * stiffness / dt + stiffness - follows * relaxing;
        bodies.force[c] += springs[n].force + inertia[n] / dt * velocity_[c] +
                           relaxing * (kept * muscle_rest_[c] + follows * offset_[c]);
    }
    // Occiput and centre of mass rise with the joint, and fall as the head extends.
    const Restoring under_head = table();
    Vector rise = Vector::Zero();
    rise[head_lift] = 1.0f;
    rise[head_extension] = -p.occiput;
    bodies.force += under_head.force * rise;
    bodies.matrix += (1.0f + p.damping_time / dt) * under_head.stiffness * rise * rise.transpose();
}

void YieldingSkeleton::advance(const Vector& step, float dt) {
    offset_ += step;
    velocity_ = step / dt;
    const float rate = relaxation_.rate(dt, recovers_);
    muscle_rest_ *= 1.0f - rate;
    if (!recovers_) {
        muscle_rest_ += rate * offset_;
    }
    place();
}

}  // namespace eti::scene
