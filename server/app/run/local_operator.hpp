// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>

#include "common/device/hand.hpp"
#include "common/operator/operator.hpp"
#include "common/operator/track_player.hpp"
#include "server/scene/scene.hpp"

namespace eti::app {

/// A scripted operator in the simulation's process: the same hands, device model and coupling as in the
/// device processes, advanced in simulation time.
class LocalOperator {
  public:
    LocalOperator(const OperatorScript& script, const Laryngoscope& scope, const Tube& tube,
                  std::uint64_t seed, const Observation& start);

    /// Advances both hands by one simulation step under the forces of the last snapshot.
    void advance(const Observation& observation, const scene::Snapshot& snapshot);

    /// Sets both tools' input poses to those of the devices.
    void apply_to(scene::Inputs& inputs) const;
    [[nodiscard]] bool finished() const { return blade_track_.finished() && tube_track_.finished(); }
    [[nodiscard]] const std::string& blade_stage() const { return blade_track_.stage_name(); }

  private:
    TrackPlayer blade_track_, tube_track_;
    HandDevice blade_hand_, tube_hand_;
    CouplingSettings coupling_;
};

}  // namespace eti::app
