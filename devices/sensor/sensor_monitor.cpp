// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/sensor_monitor.hpp"

#include <algorithm>
#include <cmath>

namespace eti::devices {

namespace {

constexpr float window = 1.0f;  // [s], over which the rate is measured

bool same(const Motion& a, const Motion& b) {
    return a.pose.translation == b.pose.translation && a.pose.rotation.coeffs() == b.pose.rotation.coeffs() &&
           a.velocity == b.velocity && a.angular_velocity == b.angular_velocity;
}

void add(std::atomic<std::uint64_t>& counter) {
    counter.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

SensorMonitor::SensorMonitor(Sensor& device, const SensorMonitorLimits& limits)
    : device_(device), limits_(limits), capabilities_(device.capabilities()) {
    // Devices without a nominal rate answer every request.
    if (capabilities_.rate > 0.0f) {
        limits_.stale_after = std::max(limits_.stale_after, 3.0f / capabilities_.rate);
    }
}

bool SensorMonitor::near(const RigidTransform& a, const RigidTransform& b, float seconds) const {
    return (a.translation - b.translation).norm() <= limits_.speed * seconds + limits_.slack &&
           rotation_vector(a.rotation * b.rotation.conjugate()).norm() <=
               limits_.turning * seconds + limits_.turning_slack;
}

bool SensorMonitor::is_plausible(const Motion& motion) {
    broken_ = !is_motion(motion);
    if (broken_) {
        add(not_finite_);
        settled_ = -1.0f;
        return false;
    }
    if (!any_ || near(motion.pose, good_.motion.pose, std::min(since_good_, limits_.stale_after))) {
        settled_ = -1.0f;
        return true;
    }
    add(jumps_);
    settled_ = settled_ >= 0.0f && near(motion.pose, elsewhere_, age_) ? settled_ + age_ : 0.0f;
    elsewhere_ = motion.pose;
    return settled_ >= limits_.settled_after;
}

bool SensorMonitor::frozen(const Motion& motion, const Wrench& wrench, float elapsed) {
    if (!same(motion, unchanged_)) {
        unchanged_ = motion;
        unchanged_time_ = 0.0f;
    } else if (capabilities_.rate > 0.0f && wrench.force.norm() > limits_.pushing) {
        unchanged_time_ += std::min(elapsed, limits_.stale_after);
    }
    // A released device does not push, so its time does not count until it moves.
    return unchanged_time_ > limits_.frozen_after;
}

Reading SensorMonitor::exchange(const Wrench& wrench, float elapsed) {
    Reading now = device_.exchange(wrench, elapsed);
    const bool new_sample = now.present && (!any_ || now.sample != sample_);
    sample_ = now.sample;
    age_ += elapsed;
    since_good_ += elapsed;
    if (new_sample && is_plausible(now.motion)) {
        good_ = now;
        any_ = true;
        since_good_ = 0.0f;
    }
    bool stuck = frozen_.load(std::memory_order_relaxed);
    if (new_sample) {
        age_ = 0.0f;
        stuck = frozen(now.motion, wrench, elapsed);
        frozen_.store(stuck, std::memory_order_relaxed);
    }
    count(!now.present || stuck || age_ > limits_.lost_after, new_sample, elapsed);

    const bool believed = settled_ < 0.0f && !broken_;
    now.motion = good_.motion;
    now.present = any_ && now.present && !broken_ && !stuck && since_good_ <= limits_.stale_after;
    if (!now.present || !believed) {
        now.motion.velocity = now.motion.angular_velocity = Vec3f::Zero();
    }
    if (!now.present) {
        now.buttons = 0;
    }
    return now;
}

void SensorMonitor::count(bool lost, bool new_sample, float elapsed) {
    if (lost && !was_lost_ && any_) {  // a device never present is not lost
        add(losses_);
    }
    was_lost_ = lost;
    lost_.store(lost, std::memory_order_relaxed);
    window_ += elapsed;
    window_samples_ += new_sample ? 1 : 0;
    if (window_ >= window) {
        const float rate = static_cast<float>(window_samples_) / window_;
        rate_.store(rate, std::memory_order_relaxed);
        slow_.store(!lost && rate < limits_.slow_share * capabilities_.rate, std::memory_order_relaxed);
        window_ = 0.0f;
        window_samples_ = 0;
    }
}

SensorHealth SensorMonitor::health() const {
    constexpr auto order = std::memory_order_relaxed;
    return {lost_.load(order),   slow_.load(order),       frozen_.load(order), rate_.load(order),
            losses_.load(order), not_finite_.load(order), jumps_.load(order)};
}

}  // namespace eti::devices
