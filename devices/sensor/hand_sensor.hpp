// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

#include "common/device/hand.hpp"
#include "common/operator/track_player.hpp"
#include "devices/sensor/drivers.hpp"

namespace eti::devices {

/// A simulated device in a scripted hand. Without a script the hand holds the device still, parked.
class HandSensor final : public Sensor {
  public:
    explicit HandSensor(const SensorSetup& setup);

    void observe(const Observation& seen) override;
    [[nodiscard]] Reading exchange(const Wrench& wrench, float elapsed) override;
    [[nodiscard]] DeviceCapabilities capabilities() const override;
    [[nodiscard]] bool finished() const override { return player_ && player_->finished(); }

  private:
    void approach(float dt);

    std::optional<TrackPlayer> at_start_, player_;
    double last_time_ = 0.0;  // [s], of the last observation
    std::uint64_t sample_ = 0;
    RigidTransform goal_;    // pose that the script wants
    RigidTransform wanted_;  // intermediate pose, limited to a hand's speed
    HandDevice hand_;
};

}  // namespace eti::devices
