// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/bus/convert.hpp"
#include "common/math/transform.hpp"

namespace eti::bus {

/// Positions travel as places in a box [m]: lower + place / 65535 * (upper - lower).
struct Box {
    Vec3f lower = Vec3f::Zero(), upper = Vec3f::Zero();
};

/// Positions in a chunk; 6 bytes each and at most 120 for the rest fit one datagram of 1300 bytes.
inline constexpr std::size_t chunk_positions = 192;

/// Chunks that hold so many positions.
[[nodiscard]] constexpr std::size_t chunk_count(std::size_t positions) {
    return (positions + chunk_positions - 1) / chunk_positions;
}

/// The smallest box around the positions, at least one, whose edges are a micrometre or longer.
[[nodiscard]] Box box_around(std::span<const Vec3f> positions);

/// Positions arrive within 1/131070 of the box's edges, those beyond the box at its faces.
void put_places(const Box& box, std::span<const Vec3f> positions, std::vector<std::uint16_t>& places);

/// Adds the positions [m] to `positions`. False, and nothing added, when they cannot be right: the box is
/// empty, not finite or farther than `farthest` [m] from the origin, a position lacks a coordinate, or there
/// are more than a chunk holds.
[[nodiscard]] bool take_places(const Box& box, std::span<const std::uint16_t> places, float farthest,
                               std::vector<Vec3f>& positions);

/// The same for the members of a message.
template <class Message>
void put_positions(const Box& box, std::span<const Vec3f> positions, Message& message) {
    message.lower(to_msg(box.lower));
    message.upper(to_msg(box.upper));
    put_places(box, positions, message.places());
}

template <class Message>
[[nodiscard]] bool take_positions(const Message& message, float farthest, std::vector<Vec3f>& positions) {
    return take_places({from_msg(message.lower()), from_msg(message.upper())}, message.places(), farthest,
                       positions);
}

}  // namespace eti::bus
