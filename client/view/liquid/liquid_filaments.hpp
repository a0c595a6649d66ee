// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/view/liquid/liquid_tracks.hpp"
#include "common/model/tools/tools.hpp"

namespace eti::view {

/// A filament of liquid, visual only.
struct LiquidFilament {
    /// Attachment: a particle, or a position on a tool's capsule.
    struct End {
        std::uint32_t particle = LiquidTracks::no_particle;
        std::uint32_t tool = 0;
        float along = 0.0f;           ///< 0-1 from the capsule's a to b
        Vec3f place = Vec3f::Zero();  ///< [m]
    };
    End from, to;
    float volume = 0.0f;  ///< [m^3]
    float age = 0.0f;     ///< [s]

    [[nodiscard]] float length() const { return (to.place - from.place).norm(); }
    [[nodiscard]] float radius() const;  ///< [m], of a cylinder with its volume
};

/// Saliva forms filaments where particles, or a particle and a tool, separate and leave nothing between
/// them. A filament conserves its volume while stretched, and drains as viscoelastic filaments do: its
/// radius decays exponentially in time (Entov & Hinch 1997, J Non-Newtonian Fluid Mech 72:31). It breaks
/// when too long or too thin, and is removed when its ends meet again.
class LiquidFilaments {
  public:
    static constexpr std::size_t max_filaments = 48;

    /// `tools`: current capsules, with stable indices. `stringing` 0-1: 1 is saliva.
    void advance(const LiquidTracks& liquid, std::span<const Capsule> tools, float spacing, float dt,
                 float stringing);
    void clear();

    [[nodiscard]] std::span<const LiquidFilament> filaments() const { return filaments_; }
    /// Number of filaments dropped for lack of room.
    [[nodiscard]] std::uint64_t left_out() const { return left_out_; }

  private:
    struct Separation {
        float distance;  // [m]
        LiquidFilament::End from, to;
    };

    bool follow(LiquidFilament::End& end, const LiquidTracks& liquid, std::span<const Capsule> tools);
    void touch(const LiquidTracks& liquid, std::span<const Capsule> tools, float spacing);
    void part(const LiquidTracks& liquid, std::span<const Capsule> tools, float spacing, float volume);

    std::vector<LiquidFilament> filaments_;
    std::vector<Separation> separating_;
    std::vector<std::uint32_t> touched_, touched_before_;  // by particle: a tool, or none
    std::vector<std::uint8_t> held_;                       // by particle: whether a filament is attached
    std::uint64_t left_out_ = 0;
};

}  // namespace eti::view
