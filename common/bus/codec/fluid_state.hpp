// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/bus/codec/quantised_positions.hpp"
#include "common/math/transform.hpp"
#include "idl/eti_wire.hpp"

namespace eti::bus {

/// Liquid as transmitted: all positions lie in the box from `lower` to `upper` [m].
struct Liquid {
    Vec3f lower = Vec3f::Zero(), upper = Vec3f::Zero();
    float spacing = 1e-3f;  ///< [m], of particles at rest
    std::span<const Vec3f> positions;
};

/// Particles per chunk.
inline constexpr std::size_t fluid_chunk_particles = chunk_positions;
/// Maximum number of chunks per state: 49 thousand particles.
inline constexpr std::size_t max_fluid_chunks = 256;

/// Number of chunks for `particles`; one when there are none.
[[nodiscard]] std::size_t fluid_chunk_count(std::size_t particles);

/// Encodes chunk `which` of the liquid, except the header. Positions are accurate to 1/131070 of the box's
/// edges; positions outside the box are clamped to its faces.
void encode_fluid_chunk(const Liquid& liquid, std::size_t which, eti::msg::FluidState& message);

/// Appends the chunk's positions [m] to `positions`. Returns false and appends nothing for an invalid
/// message: a box that is empty, not finite or farther than `farthest` [m] from the origin; a spacing above
/// 10 mm; a particle without all coordinates; an impossible chunk index.
[[nodiscard]] bool decode_fluid_chunk(const eti::msg::FluidState& message, float farthest,
                                      std::vector<Vec3f>& positions);

}  // namespace eti::bus
