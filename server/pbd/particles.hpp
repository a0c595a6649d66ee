// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/math/transform.hpp"

namespace eti::pbd {

/// Collision channels of a particle, as bits.
namespace channel {
inline constexpr std::uint8_t blade = 1;  ///< the laryngoscope's capsules
inline constexpr std::uint8_t tube = 2;   ///< the tube's segments
inline constexpr std::uint8_t shell = 4;  ///< the offset shell (tongue and fluid only; other tissue lies
                                          ///< inside it)
}  // namespace channel

/// State of all particles, as a structure of arrays [particles]; lengths in metres, masses in kilograms.
struct Particles {
    std::vector<Vec3f> position;
    std::vector<Vec3f> predicted;     ///< position at the end of this substep, as moved by constraints
    std::vector<Vec3f> velocity;      ///< [m/s]
    std::vector<Vec3f> rest;          ///< unloaded position in the current posture
    std::vector<float> inverse_mass;  ///< [1/kg]; 0: moves with its bone only
    std::vector<float> radius;
    std::vector<std::uint8_t> channels;
    std::vector<std::uint8_t> object;                 ///< caller's tag (tissue)
    std::vector<std::uint8_t> asleep;                 ///< 1: at rest, not moved until woken (see Sleep)
    std::vector<std::array<std::uint32_t, 2>> awake;  ///< ranges of awake particles: first and one past the
                                                      ///< last, ascending

    [[nodiscard]] std::size_t size() const { return position.size(); }
    /// Inverse mass [1/kg] for contacts and constraints; 0 while asleep.
    [[nodiscard]] float mobility(std::size_t i) const { return asleep[i] != 0 ? 0.0f : inverse_mass[i]; }
    /// Calls body(particle) for each awake particle, ascending.
    template <class Body>
    void for_awake(const Body& body) const {
        for (const auto& [begin, end] : awake) {
            for (std::uint32_t i = begin; i < end; ++i) {
                body(i);
            }
        }
    }
    void resize(std::size_t count) {
        position.resize(count, Vec3f::Zero());
        predicted.resize(count, Vec3f::Zero());
        velocity.resize(count, Vec3f::Zero());
        rest.resize(count, Vec3f::Zero());
        inverse_mass.resize(count, 0.0f);
        radius.resize(count, 0.0f);
        channels.resize(count, 0);
        object.resize(count, 0);
        asleep.assign(count, 0);
        awake.reserve(count / 2 + 1);  // worst case (every other one awake): a step does not allocate
        awake.assign(1, {0, static_cast<std::uint32_t>(count)});
    }
};

}  // namespace eti::pbd
