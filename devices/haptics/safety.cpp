// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/safety.hpp"

#include <algorithm>

namespace eti::devices {

namespace {

Vec3f approached(const Vec3f& last, const Vec3f& wanted, float most) {
    const Vec3f way = wanted - last;
    const float length = way.norm();
    return length > most ? Vec3f(last + way * (most / length)) : wanted;
}

/// `force` without its component along `part`, limited to `part` itself.
Vec3f without(const Vec3f& force, const Vec3f& part) {
    const float length = part.norm();
    if (length <= 0.0f) {
        return force;
    }
    const Vec3f along = part / length;
    return force - std::clamp(force.dot(along), 0.0f, length) * along;
}

}  // namespace

float Freshness::update(float age) {
    // By the age, not by the number of cycles, which may be late themselves.
    const float held = settings_.stale_after();
    const float left = (settings_.silence_limit - age) / (settings_.silence_limit - held);
    share_ = age >= 0.0f ? std::clamp(left, 0.0f, 1.0f) : 0.0f;
    return share_;
}

Wrench ForceRecoveryRamp::update(const Wrench& wanted, const Wrench& exerted, bool after_gap, float dt,
                                 const CouplingSettings& coupling) {
    if (after_gap) {
        lacking_ = {without(wanted.force, exerted.force), without(wanted.torque, exerted.torque)};
    }
    const float share = dt / settings_.return_time;
    lacking_ = {approached(lacking_.force, Vec3f::Zero(), share * coupling.force_limit),
                approached(lacking_.torque, Vec3f::Zero(), share * coupling.torque_limit)};
    return {without(wanted.force, lacking_.force), without(wanted.torque, lacking_.torque)};
}

bool ForceRecoveryRamp::active() const {
    constexpr float force = 0.05f, torque = 0.0025f;  // [N], [N m] at 50 mm
    return lacking_.force.norm() > force || lacking_.torque.norm() > torque;
}

float Engagement::update(bool there, float force, float dt) {
    if (!there) {
        share_ = 0.0f;
        cycles_ = 0;
        return share_;
    }
    if (cycles_ < settings_.quiet_cycles) {
        cycles_ = !needs_quiet_ || force < settings_.quiet_force ? cycles_ + 1 : 0;
        return share_;
    }
    needs_quiet_ = false;
    share_ = std::min(1.0f, share_ + dt / (back_ ? settings_.return_time : settings_.ramp_time));
    back_ = back_ || share_ >= 1.0f;
    return share_;
}

void Engagement::disengage() {
    needs_quiet_ = true;
    back_ = false;
    cycles_ = 0;
    share_ = 0.0f;
}

Wrench rate_limited(const Wrench& wanted, const Wrench& last, float dt, const CouplingSettings& settings) {
    const float force = settings.force_rate_limit * dt;
    const float torque = force * settings.torque_limit / std::max(settings.force_limit, 0.1f);
    return {approached(last.force, wanted.force, force), approached(last.torque, wanted.torque, torque)};
}

}  // namespace eti::devices
