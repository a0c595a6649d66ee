// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/polled_sensor.hpp"

#include <utility>

namespace eti::devices {

namespace {

constexpr std::chrono::milliseconds sensor_retry_interval{1000};
constexpr std::chrono::milliseconds ending_interval{20};
// [s], smoothing of velocities: a tracker's noise of 0.5 mm at 240 Hz would be 0.17 m/s.
constexpr float velocity_memory = 0.02f;
constexpr float longest_velocity_interval = 0.1f;  // [s]; after a longer gap the velocity is unknown

std::int64_t now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace

PolledSensor::PolledSensor(std::unique_ptr<SampleSource> source, const RigidTransform& start)
    : source_(std::move(source)) {
    measured_.sample.pose = start;
    newest_.write(measured_);
    source_->open();
    thread_ = std::thread([this] { run(); });
}

PolledSensor::~PolledSensor() {
    ending_.store(true, std::memory_order_relaxed);
    thread_.join();
}

DeviceCapabilities PolledSensor::capabilities() const {
    return {.force = 0.0f, .torque = 0.0f, .rate = source_->rate()};
}

Reading PolledSensor::exchange(const Wrench&, float) {
    const Measured* measured = nullptr;
    (void)newest_.read(measured);
    ++calls_;
    Reading reading;
    reading.motion = {measured->sample.pose, measured->velocity, measured->angular_velocity};
    reading.buttons = measured->sample.buttons;
    reading.axes = measured->sample.axes;
    // A source that reports only changes is up to date while it is open; for one that measures, the start
    // pose is not a measurement.
    const bool measures = source_->rate() > 0.0f;
    reading.sample = measures ? measured->number : calls_;
    reading.present = present_.load(std::memory_order_relaxed) && (!measures || measured->number > 0);
    return reading;
}

std::string PolledSensor::fault() const {
    const std::lock_guard lock(mutex_);
    return fault_;
}

void PolledSensor::report(const std::string& fault) {
    const std::lock_guard lock(mutex_);
    fault_ = fault;
}

void PolledSensor::run() {
    bool open = true;
    auto retry = std::chrono::steady_clock::now();
    while (!ending_.load(std::memory_order_relaxed)) {
        try {
            if (!open) {
                if (std::chrono::steady_clock::now() < retry) {
                    std::this_thread::sleep_for(ending_interval);
                    continue;
                }
                source_->open();
                open = true;
                report({});
                present_.store(true, std::memory_order_relaxed);
            }
            if (source_->read(measured_.sample)) {
                estimate_velocity(measured_.sample.pose, now_ns());
                ++measured_.number;
                newest_.write(measured_);
            }
        } catch (const DeviceError& error) {
            report(error.what());
            present_.store(false, std::memory_order_relaxed);
            if (open) {
                source_->close();
                open = false;
            }
            measured_at_ = 0;
            retry = std::chrono::steady_clock::now() + sensor_retry_interval;
        }
    }
    if (open) {
        source_->close();
    }
}

void PolledSensor::estimate_velocity(const RigidTransform& pose, std::int64_t now) {
    const float dt = static_cast<float>(now - measured_at_) * 1e-9f;
    const RigidTransform& last = last_pose_;
    if (measured_at_ != 0 && dt > 0.0f && dt < longest_velocity_interval) {
        const float share = dt / (velocity_memory + dt);
        const Vec3f turn = rotation_vector(pose.rotation * last.rotation.conjugate());
        measured_.velocity += share * ((pose.translation - last.translation) / dt - measured_.velocity);
        measured_.angular_velocity += share * (turn / dt - measured_.angular_velocity);
    }
    if (measured_at_ == 0 || dt >= longest_velocity_interval || !measured_.velocity.allFinite() ||
        !measured_.angular_velocity.allFinite()) {
        measured_.velocity = measured_.angular_velocity = Vec3f::Zero();
    }
    last_pose_ = pose;
    measured_at_ = now;
}

}  // namespace eti::devices
