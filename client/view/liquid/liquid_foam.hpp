// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/view/liquid/liquid_tracks.hpp"
#include "common/math/random.hpp"

namespace eti::view {

/// A bubble of foam.
struct Bubble {
    Vec3f position = Vec3f::Zero();  ///< [m]
    float radius = 0.0f;             ///< [m], fully grown
    float age = 0.0f, life = 0.0f;   ///< [s]

    /// Current radius [m]: grows within a twentieth of a second, and shrinks as the bubble drains.
    [[nodiscard]] float radius_now() const;
};

/// Visual foam (Ihmsen, Akinci, Akinci & Teschner 2012, "Unified spray, foam and bubbles for particle-based
/// fluids"): liquid entraps air where neighbours collide and where a crest moves outward, in proportion to
/// speed. Differences from the paper: thresholds are about two orders lower, as saliva creeps; only liquid
/// near its surface entraps air; all of it becomes foam on the surface, without spray and free bubbles.
/// Deterministic.
class LiquidFoam {
  public:
    static constexpr std::size_t max_bubbles = 1000;

    /// Ages the bubbles by `dt` [s] and adds those that the newest state entraps. `foaming` 0-1: 1 is
    /// saliva.
    void advance(const LiquidTracks& liquid, float spacing, float dt, float foaming);
    void clear();

    [[nodiscard]] std::span<const Bubble> bubbles() const { return bubbles_; }
    /// Bubbles dropped for lack of room. More than `max_bubbles` could hardly be distinguished.
    [[nodiscard]] std::uint64_t left_out() const { return left_out_; }

  private:
    void carry(const LiquidTracks& liquid, float spacing, float dt);
    void entrap(const LiquidTracks& liquid, std::uint32_t i, float spacing, float dt, float foaming);

    std::vector<Bubble> bubbles_;
    std::uint64_t left_out_ = 0;
    Random random_{0x0f0a3};
};

}  // namespace eti::view
