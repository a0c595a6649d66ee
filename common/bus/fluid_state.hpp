// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/bus/places.hpp"
#include "common/math/transform.hpp"
#include "idl/eti.h"

namespace eti::bus {

/// Liquid as it travels: all positions lie in the box from `lower` to `upper` [m].
struct Liquid {
    Vec3f lower = Vec3f::Zero(), upper = Vec3f::Zero();
    float spacing = 1e-3f;  ///< [m], of particles at rest
    std::span<const Vec3f> positions;
};

/// Particles in a chunk.
inline constexpr std::size_t fluid_chunk_particles = chunk_positions;
/// Chunks of a state at most: 49 thousand particles.
inline constexpr std::size_t most_fluid_chunks = 256;

/// Chunks that hold `particles`; one when there are none.
[[nodiscard]] std::size_t fluid_chunk_count(std::size_t particles);

/// Chunk `which` of the liquid; all but the header. Positions arrive within 1/131070 of the box's edges,
/// those beyond the box at its faces.
void put_fluid_chunk(const Liquid& liquid, std::size_t which, eti::msg::FluidState& message);

/// Adds the chunk's positions [m] to `positions`. False, and nothing added, when the message cannot be right:
/// its box is empty, not finite or farther than `farthest` [m] from the origin, its spacing is not that of
/// drops (at most 10 mm), a particle lacks a coordinate, or its place among the chunks is impossible.
[[nodiscard]] bool take_fluid_chunk(const eti::msg::FluidState& message, float farthest,
                                    std::vector<Vec3f>& positions);

}  // namespace eti::bus
