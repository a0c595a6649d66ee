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

    void look(const Observation& seen) override;
    [[nodiscard]] Reading exchange(const Wrench& wrench, float elapsed) override;
    [[nodiscard]] Abilities abilities() const override;
    [[nodiscard]] bool finished() const override { return player_ && player_->finished(); }

  private:
    void approach(float dt);

    std::optional<TrackPlayer> at_start_, player_;
    double last_time_ = 0.0;  // [s], of the last look
    std::uint64_t sample_ = 0;
    RigidTransform goal_;    // where the script wants the tool
    RigidTransform wanted_;  // on the way there, no faster than a hand moves
    HandDevice hand_;
};

}  // namespace eti::devices
