// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>

#include "client/view/liquid_foam.hpp"
#include "client/view/liquid_strings.hpp"
#include "client/view/liquid_tracks.hpp"
#include "common/model/liquid_kind.hpp"

namespace eti::view {

/// What is seen of a liquid beyond its particles, from state to state: foam and threads. A state without
/// liquid costs nothing.
class LiquidDetail {
  public:
    /// More particles than a server sends are drawn without: the work goes with their number.
    static constexpr std::size_t most_particles = 8000;

    /// A state of simulation time `time_ns`; one that is not later than the last begins anew. After a
    /// gap threads are gone, and foam is older.
    void advance(std::uint64_t time_ns, std::span<const Vec3f> positions, float spacing,
                 std::span<const Capsule> tools);
    /// How much it foams and is drawn into threads; saliva until it is said.
    void set_kind(const LiquidProperties& liquid) { liquid_ = liquid; }
    void clear();

    [[nodiscard]] const LiquidTracks& tracks() const { return tracks_; }
    [[nodiscard]] const LiquidFoam& foam() const { return foam_; }
    [[nodiscard]] const LiquidStrings& strings() const { return strings_; }

  private:
    std::uint64_t time_ns_ = 0;
    LiquidProperties liquid_ = properties_of(LiquidKind::saliva);
    LiquidTracks tracks_;
    LiquidFoam foam_;
    LiquidStrings strings_;
};

}  // namespace eti::view
