// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "common/math/transform.hpp"

namespace eti::pbd {

/// What a particle may collide with, as bits of its channels.
namespace channel {
inline constexpr std::uint8_t blade = 1;  ///< the laryngoscope's capsules
inline constexpr std::uint8_t tube = 2;   ///< the tube's segments
inline constexpr std::uint8_t shell = 4;  ///< the offset shell (tongue and fluid only: tissue is inside it)
}  // namespace channel

/// State of all particles, structure of arrays; lengths in metres, masses in kilograms.
struct Particles {
    std::vector<Vec3f> position;
    std::vector<Vec3f> predicted;     ///< where the constraints move the particle in this substep
    std::vector<Vec3f> velocity;      ///< [m/s]
    std::vector<Vec3f> rest;          ///< unloaded position in the current posture
    std::vector<float> inverse_mass;  ///< [1/kg]; 0: moves only with its bone
    std::vector<float> radius;
    std::vector<std::uint8_t> channels;
    std::vector<std::uint8_t> object;  ///< caller's tag (tissue)

    [[nodiscard]] std::size_t size() const { return position.size(); }
    void resize(std::size_t count) {
        position.resize(count, Vec3f::Zero());
        predicted.resize(count, Vec3f::Zero());
        velocity.resize(count, Vec3f::Zero());
        rest.resize(count, Vec3f::Zero());
        inverse_mass.resize(count, 0.0f);
        radius.resize(count, 0.0f);
        channels.resize(count, 0);
        object.resize(count, 0);
    }
};

}  // namespace eti::pbd
