// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <string>

#include "common/math/random.hpp"
#include "common/operator/operator.hpp"

namespace eti {

/// Plays one track of a script: turns what is observed into the pose the hand wants.
/// Deterministic in script, seed and observations. The pose is that of the tool's frame
/// (laryngoscope: see Laryngoscope; tube: grip, see Tube).
class TrackPlayer {
  public:
    /// `tool_length` [m]: from the tool frame's origin to its tip along +z (blade length; grip to tip).
    TrackPlayer(const Track& track, float tool_length, float tremor, float reaction, std::uint64_t seed);

    /// Pose wanted at `observation.time`; call with non-decreasing times.
    [[nodiscard]] RigidTransform wanted(const Observation& observation);

    [[nodiscard]] bool finished() const;
    [[nodiscard]] bool gave_up() const { return gave_up_; }
    [[nodiscard]] const std::string& stage_name() const;

  private:
    Track track_;
    float tool_length_;
    float tremor_;
    float reaction_;
    Random random_;
    std::size_t stage_ = 0;
    bool gave_up_ = false;
    // The implementation adds its own state here.
};

}  // namespace eti
