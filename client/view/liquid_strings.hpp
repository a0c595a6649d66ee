// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/view/liquid_tracks.hpp"
#include "common/model/tools.hpp"

namespace eti::view {

/// A thread of liquid, seen only.
struct LiquidString {
    /// Where it hangs on: a particle, or a place along a tool's capsule.
    struct End {
        std::uint32_t particle = LiquidTracks::nobody;
        std::uint32_t tool = 0;
        float along = 0.0f;           ///< 0-1 from the capsule's a to its b
        Vec3f place = Vec3f::Zero();  ///< [m]
    };
    End from, to;
    float volume = 0.0f;  ///< [m^3]
    float age = 0.0f;     ///< [s]

    [[nodiscard]] float length() const { return (to.place - from.place).norm(); }
    [[nodiscard]] float radius() const;  ///< [m], of a cylinder of its volume
};

/// Saliva is drawn into threads where particles, or a particle and a tool, part and leave nothing between
/// them. A thread keeps its volume as it is drawn out, and drains as viscoelastic filaments do: its radius
/// falls exponentially in time (Entov & Hinch 1997, J Non-Newtonian Fluid Mech 72:31). It breaks where it
/// gets too long or too thin, and is gone where its ends come together again.
class LiquidStrings {
  public:
    static constexpr std::size_t most = 48;

    /// `tools` as they are now; an index is always the same tool's. `stringing` 0-1: 1 is saliva.
    void advance(const LiquidTracks& liquid, std::span<const Capsule> tools, float spacing, float dt,
                 float stringing);
    void clear();

    [[nodiscard]] std::span<const LiquidString> strings() const { return strings_; }
    /// That found no room.
    [[nodiscard]] std::uint64_t left_out() const { return left_out_; }

  private:
    struct Parting {
        float distance;  // [m]
        LiquidString::End from, to;
    };

    bool follow(LiquidString::End& end, const LiquidTracks& liquid, std::span<const Capsule> tools);
    void touch(const LiquidTracks& liquid, std::span<const Capsule> tools, float spacing);
    void part(const LiquidTracks& liquid, std::span<const Capsule> tools, float spacing, float volume);

    std::vector<LiquidString> strings_;
    std::vector<Parting> parting_;
    std::vector<std::uint32_t> touched_, touched_before_;  // by particle: a tool, or nobody
    std::vector<std::uint8_t> held_;                       // by particle: whether a string hangs on it
    std::uint64_t left_out_ = 0;
};

}  // namespace eti::view
