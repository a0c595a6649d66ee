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

}  // namespace

float Freshness::update(float age, float dt) {
    const bool fresh = age >= 0.0f && age <= settings_.stale_after();
    if (!fresh) {
        // By the age and not by the cycles, which may come late themselves.
        const float left = (settings_.silence_limit - age) / settings_.fade_time;
        share_ = age >= 0.0f ? std::min(share_, std::max(left, 0.0f)) : 0.0f;
        calm_ = 0.0f;
        return share_;
    }
    if (!heard_) {
        heard_ = true;
        share_ = 1.0f;
    }
    calm_ += dt;
    if (calm_ > settings_.recovery_wait) {
        share_ = std::min(share_ + dt / settings_.recovery_time, 1.0f);
    }
    return share_;
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
    share_ = std::min(1.0f, share_ + dt / settings_.ramp_time);
    return share_;
}

void Engagement::disengage() {
    needs_quiet_ = true;
    cycles_ = 0;
    share_ = 0.0f;
}

Wrench rate_limited(const Wrench& wanted, const Wrench& last, float dt, const CouplingSettings& settings) {
    const float force = settings.force_rate_limit * dt;
    const float torque = force * settings.torque_limit / std::max(settings.force_limit, 0.1f);
    return {approached(last.force, wanted.force, force), approached(last.torque, wanted.torque, torque)};
}

}  // namespace eti::devices
