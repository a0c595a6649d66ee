// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>

#include "client/view/liquid/liquid_filaments.hpp"
#include "client/view/liquid/liquid_foam.hpp"
#include "client/view/liquid/liquid_tracks.hpp"
#include "common/model/liquid_kind.hpp"

namespace eti::view {

/// Visual detail of a liquid beyond its particles, advanced from state to state: foam and filaments. Costs
/// nothing without liquid.
class LiquidDetail {
  public:
    /// Above this number, which no server sends, detail is omitted: its cost grows with the number of
    /// particles.
    static constexpr std::size_t max_particles = 8000;

    /// Advances to simulation time `time_ns`; a time not later than the last restarts. After a gap
    /// filaments are removed, and foam has aged.
    void advance(std::uint64_t time_ns, std::span<const Vec3f> positions, float spacing,
                 std::span<const Capsule> tools);
    /// Sets how strongly it foams and forms filaments; initially saliva.
    void set_kind(const LiquidProperties& liquid) { liquid_ = liquid; }
    void clear();

    [[nodiscard]] const LiquidTracks& tracks() const { return tracks_; }
    [[nodiscard]] const LiquidFoam& foam() const { return foam_; }
    [[nodiscard]] const LiquidFilaments& filaments() const { return filaments_; }

  private:
    std::uint64_t time_ns_ = 0;
    LiquidProperties liquid_ = properties_of(LiquidKind::saliva);
    LiquidTracks tracks_;
    LiquidFoam foam_;
    LiquidFilaments filaments_;
};

}  // namespace eti::view
