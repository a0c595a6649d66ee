// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/bus/codec/convert.hpp"
#include "common/math/transform.hpp"

namespace eti::bus {

/// Positions are transmitted as 16-bit coordinates in a box [m]: lower + place / 65535 * (upper - lower).
struct Box {
    Vec3f lower = Vec3f::Zero(), upper = Vec3f::Zero();
};

/// Positions per chunk; 6 bytes each and at most 120 for the rest fit one datagram of 1300 bytes.
inline constexpr std::size_t chunk_positions = 192;

/// Number of chunks for `positions`.
[[nodiscard]] constexpr std::size_t chunk_count(std::size_t positions) {
    return (positions + chunk_positions - 1) / chunk_positions;
}

/// Bounding box of the positions (at least one), with edges of at least one micrometre.
[[nodiscard]] Box box_around(std::span<const Vec3f> positions);

/// Positions are accurate to 1/131070 of the box's edges; positions outside the box are clamped to its faces.
void quantise_positions(const Box& box, std::span<const Vec3f> positions, std::vector<std::uint16_t>& places);

/// Appends the positions [m] to `positions`. Returns false and appends nothing for invalid input: a box that
/// is empty, not finite or farther than `farthest` [m] from the origin, a position without all coordinates,
/// or more positions than a chunk holds.
[[nodiscard]] bool dequantise_positions(const Box& box, std::span<const std::uint16_t> places, float farthest,
                                        std::vector<Vec3f>& positions);

/// The same for the members of a message.
template <class Message>
void encode_positions(const Box& box, std::span<const Vec3f> positions, Message& message) {
    message.lower(to_msg(box.lower));
    message.upper(to_msg(box.upper));
    quantise_positions(box, positions, message.places());
}

template <class Message>
[[nodiscard]] bool decode_positions(const Message& message, float farthest, std::vector<Vec3f>& positions) {
    return dequantise_positions({from_msg(message.lower()), from_msg(message.upper())}, message.places(),
                                farthest, positions);
}

}  // namespace eti::bus
