// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <memory>

#include "devices/sensor/sensor.hpp"

namespace eti::devices {

/// Plausibility limits for a device's poses.
struct SensorMonitorLimits {
    float speed = 3.0f;          ///< [m/s]; a fast hand reaches about 1 m/s
    float turning = 30.0f;       ///< [rad/s]
    float slack = 5e-3f;         ///< [m], of noise between two samples
    float turning_slack = 0.1f;  ///< [rad]
    float settled_after = 0.3f;  ///< [s] of plausible samples at a new place before it is accepted
    float stale_after = 25e-3f;  ///< [s] without a sample: no force on an old pose
    float lost_after = 0.5f;     ///< [s] without a sample: lost
    float slow_share = 0.6f;     ///< of the nominal rate; a lower one is reported
    /// [s] of new samples identical to the last bit while the device pushes: frozen. A pushed hand trembles
    /// by more than an encoder's step (0.02 to 0.06 mm) within about a second. A stylus in its holder does
    /// not, and loses only a force that nobody feels.
    float frozen_after = 5.0f;
    float pushing = 0.3f;  ///< [N], a resting device with a smaller force is ignored
};

/// Health of a device; copied while the loop runs.
struct SensorHealth {
    bool lost = false;             ///< now
    bool slow = false;             ///< over the last second
    bool frozen = false;           ///< now: new samples arrive, but all are equal
    float rate = 0.0f;             ///< [1/s], measurements over the last second
    std::uint64_t losses = 0;      ///< number of losses
    std::uint64_t not_finite = 0;  ///< samples that are not finite, or have no valid rotation
    std::uint64_t jumps = 0;       ///< samples farther from the last than a hand can move
};

/// Sits between a loop and a device and passes only motions that a hand could make. A reading that jumps is
/// replaced by the last good one, at rest; a device that stays at the new place is accepted again. After
/// `stale_after` without a good reading, or at once for a non-finite one, the device counts as not present,
/// so that it receives no force. The same holds for a device with a nominal rate that pushes on a hand and
/// reports no change of a single bit for seconds: that hand could not get away. It is accepted again once it
/// moves. Allocates nothing, locks nothing.
class SensorMonitor final : public Sensor {
  public:
    explicit SensorMonitor(Sensor& device, const SensorMonitorLimits& limits = {});

    void observe(const Observation& seen) override { device_.observe(seen); }
    [[nodiscard]] Reading exchange(const Wrench& wrench, float elapsed) override;
    [[nodiscard]] DeviceCapabilities capabilities() const override { return capabilities_; }
    [[nodiscard]] bool finished() const override { return device_.finished(); }
    [[nodiscard]] bool start_servo(ServoCycle& cycle) override { return device_.start_servo(cycle); }
    void stop_servo() override { device_.stop_servo(); }
    void poll_events() override { device_.poll_events(); }
    [[nodiscard]] std::string fault() const override { return device_.fault(); }

    /// Thread-safe.
    [[nodiscard]] SensorHealth health() const;

  private:
    [[nodiscard]] bool is_plausible(const Motion& motion);
    [[nodiscard]] bool near(const RigidTransform& a, const RigidTransform& b, float seconds) const;
    void count(bool lost, bool new_sample, float elapsed);
    /// Whether the newest sample is stiller than a hand can be.
    [[nodiscard]] bool frozen(const Motion& motion, const Wrench& wrench, float elapsed);

    Sensor& device_;
    SensorMonitorLimits limits_;
    DeviceCapabilities capabilities_;
    Reading good_;
    bool any_ = false;          // a first good reading has arrived
    bool broken_ = false;       // the newest one is not finite, or has no valid rotation
    std::uint64_t sample_ = 0;  // of the last reading
    float age_ = 0.0f;          // [s], of the last sample
    float since_good_ = 0.0f;   // [s], between the last good sample and this one
    RigidTransform elsewhere_;  // reported pose while it is not accepted
    float settled_ = -1.0f;     // [s] near that pose; negative: no such pose
    Motion unchanged_;          // value of all recent samples
    float unchanged_time_ = 0;  // [s], duration of that while the device pushed
    float window_ = 0.0f;       // [s], elapsed part of the rate window
    std::uint32_t window_samples_ = 0;
    bool was_lost_ = false;

    std::atomic<bool> lost_{false}, slow_{false}, frozen_{false};
    std::atomic<float> rate_{0.0f};
    std::atomic<std::uint64_t> losses_{0}, not_finite_{0}, jumps_{0};
};

}  // namespace eti::devices
