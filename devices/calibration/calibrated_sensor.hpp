// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>
#include <utility>

#include "devices/calibration/calibration_file.hpp"
#include "devices/sensor/sensor.hpp"

namespace eti::devices {

/// Wraps a device so that its readings and wrenches are those of the tool in the patient frame.
class CalibratedSensor final : public Sensor {
  public:
    CalibratedSensor(std::unique_ptr<Sensor> device, const Calibration& calibration)
        : device_(std::move(device)),
          to_patient_(calibration.to_patient),
          tool_(calibration.tool),
          max_torque_(device_->capabilities().torque) {}

    [[nodiscard]] Reading exchange(const Wrench& wrench, float elapsed) override {
        // The same force at another point: the moving part's origin instead of the tool's.
        const Vec3f arm = last_.rotation * tool_.translation;
        const Quatf back = to_patient_.rotation.conjugate();
        Wrench there{back * wrench.force, back * wrench.torque + arm.cross(back * wrench.force)};
        // A force far from the moving part needs more torque than the motors may exert.
        const float torque = there.torque.norm();
        there.torque *= torque > max_torque_ ? max_torque_ / torque : 1.0f;
        Reading reading = device_->exchange(there, elapsed);
        Motion& motion = reading.motion;
        if (is_motion(motion)) {
            last_ = motion.pose;
        }
        const Vec3f offset = motion.pose.rotation * tool_.translation;
        motion.velocity =
            to_patient_.rotation * Vec3f(motion.velocity + motion.angular_velocity.cross(offset));
        motion.angular_velocity = to_patient_.rotation * motion.angular_velocity;
        motion.pose = to_patient_ * motion.pose * tool_;
        return reading;
    }

    void observe(const Observation& seen) override { device_->observe(seen); }
    [[nodiscard]] DeviceCapabilities capabilities() const override { return device_->capabilities(); }
    [[nodiscard]] bool finished() const override { return device_->finished(); }
    [[nodiscard]] bool start_servo(ServoCycle& cycle) override { return device_->start_servo(cycle); }
    void stop_servo() override { device_->stop_servo(); }
    void poll_events() override { device_->poll_events(); }
    [[nodiscard]] std::string fault() const override { return device_->fault(); }

  private:
    std::unique_ptr<Sensor> device_;
    RigidTransform to_patient_, tool_;
    float max_torque_;     // [N m]
    RigidTransform last_;  // of the moving part, device frame
};

}  // namespace eti::devices
