// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <memory>

#include "devices/sensor/sensor.hpp"

namespace eti::devices {

/// What a device's poses must keep to in order to be believed.
struct WatchLimits {
    float speed = 3.0f;          ///< [m/s]; a fast hand reaches about 1 m/s
    float turning = 30.0f;       ///< [rad/s]
    float slack = 5e-3f;         ///< [m], of noise between two samples
    float turning_slack = 0.1f;  ///< [rad]
    float settled_after = 0.3f;  ///< [s] of believable samples about a new place, before it is believed
    float stale_after = 25e-3f;  ///< [s] without a sample: no force on an old pose
    float lost_after = 0.5f;     ///< [s] without a sample: lost
    float slow_share = 0.6f;     ///< of the device's own rate; less is reported
    /// [s] of new samples that equal each other to the last bit while the device pushes: frozen. A hand that
    /// is pushed trembles by more than an encoder's step (0.02 to 0.06 mm) within a second or so; a stylus in
    /// its holder does not, and loses no more than a force that nobody feels.
    float frozen_after = 5.0f;
    float pushing = 0.3f;  ///< [N], below which a device that rests is left alone
};

/// How a device has been doing; copied out while the loop runs.
struct SensorHealth {
    bool lost = false;             ///< now
    bool slow = false;             ///< over the last second
    bool frozen = false;           ///< now: new samples come, but they all say the same
    float rate = 0.0f;             ///< [1/s], measurements over the last second
    std::uint64_t losses = 0;      ///< times it went
    std::uint64_t not_finite = 0;  ///< samples that are not finite, or no rotation
    std::uint64_t jumps = 0;       ///< samples farther from the last than a hand moves
};

/// Stands between a loop and a device and lets through only what a hand could have done. A reading that
/// jumps is replaced by the last good one, at rest; a device that stays at the new place is believed again.
/// Where no good one has come for `stale_after`, and at once where one is not finite, the device is not
/// present, so that no force answers it. Nor is a device that pushes on a hand, with a rate of its own, and
/// does not see it move by a bit for seconds: that hand could not get away. It is believed again once it
/// moves. Allocates nothing, locks nothing.
class SensorWatch final : public Sensor {
  public:
    explicit SensorWatch(Sensor& device, const WatchLimits& limits = {});

    void look(const Observation& seen) override { device_.look(seen); }
    [[nodiscard]] Reading exchange(const Wrench& wrench, float elapsed) override;
    [[nodiscard]] Abilities abilities() const override { return abilities_; }
    [[nodiscard]] bool finished() const override { return device_.finished(); }
    [[nodiscard]] bool start_servo(ServoCycle& cycle) override { return device_.start_servo(cycle); }
    void stop_servo() override { device_.stop_servo(); }
    void tend() override { device_.tend(); }
    [[nodiscard]] std::string fault() const override { return device_.fault(); }

    /// From any thread.
    [[nodiscard]] SensorHealth health() const;

  private:
    [[nodiscard]] bool believable(const Motion& motion);
    [[nodiscard]] bool near(const RigidTransform& a, const RigidTransform& b, float seconds) const;
    void count(bool lost, bool new_sample, float elapsed);
    /// Whether the device stands still as no hand does, by its newest sample.
    [[nodiscard]] bool frozen(const Motion& motion, const Wrench& wrench, float elapsed);

    Sensor& device_;
    WatchLimits limits_;
    Abilities abilities_;
    Reading good_;
    bool any_ = false;          // a first good reading has come
    bool broken_ = false;       // the newest one is not finite, or no rotation
    std::uint64_t sample_ = 0;  // of the last reading
    float age_ = 0.0f;          // [s], of the last sample
    float since_good_ = 0.0f;   // [s], between the last good sample and this one
    RigidTransform elsewhere_;  // where the device says it is, while that is not believed
    float settled_ = -1.0f;     // [s] that it has been about there; negative: nowhere
    Motion unchanged_;          // what all samples have said
    float unchanged_time_ = 0;  // [s], for so long, while the device pushed
    float window_ = 0.0f;       // [s] of the present second
    std::uint32_t window_samples_ = 0;
    bool was_lost_ = false;

    std::atomic<bool> lost_{false}, slow_{false}, frozen_{false};
    std::atomic<float> rate_{0.0f};
    std::atomic<std::uint64_t> losses_{0}, not_finite_{0}, jumps_{0};
};

}  // namespace eti::devices
