// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/view/liquid_tracks.hpp"
#include "common/math/random.hpp"

namespace eti::view {

/// A bubble of foam.
struct Bubble {
    Vec3f position = Vec3f::Zero();  ///< [m]
    float radius = 0.0f;             ///< [m], when grown
    float age = 0.0f, life = 0.0f;   ///< [s]

    /// [m], as it is: grows within a twentieth of a second, and shrinks as it drains.
    [[nodiscard]] float radius_now() const;
};

/// Foam that is seen only (Ihmsen, Akinci, Akinci & Teschner 2012, "Unified spray, foam and bubbles for
/// particle-based fluids"): liquid entraps air where neighbours run at each other and where a crest moves
/// outward, the more the faster it is. Departures from the paper: saliva creeps, so that the thresholds are
/// lower by about two orders; it must be near its surface to entrap air; what is entrapped clings to the
/// surface as foam, spray and free bubbles are left out. Same states, same foam.
class LiquidFoam {
  public:
    static constexpr std::size_t most = 1000;

    /// Ages what there is by `dt` [s] and adds what the newest state entraps. `foaming` 0-1: 1 is saliva.
    void advance(const LiquidTracks& liquid, float spacing, float dt, float foaming);
    void clear();

    [[nodiscard]] std::span<const Bubble> bubbles() const { return bubbles_; }
    /// Bubbles that found no room. More than `most` would hardly be told apart.
    [[nodiscard]] std::uint64_t left_out() const { return left_out_; }

  private:
    void carry(const LiquidTracks& liquid, float spacing, float dt);
    void entrap(const LiquidTracks& liquid, std::uint32_t i, float spacing, float dt, float foaming);

    std::vector<Bubble> bubbles_;
    std::uint64_t left_out_ = 0;
    Random random_{0x0f0a3};
};

}  // namespace eti::view
