// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/codec/fluid_state.hpp"

#include <algorithm>
#include <cstdint>

namespace eti::bus {

namespace {

constexpr float largest_spacing = 10e-3f;  // [m]

}  // namespace

std::size_t fluid_chunk_count(std::size_t particles) {
    return std::max<std::size_t>(1, chunk_count(particles));
}

void encode_fluid_chunk(const Liquid& liquid, std::size_t which, eti::msg::FluidState& message) {
    message.chunk(static_cast<std::uint16_t>(which));
    message.chunks(static_cast<std::uint16_t>(fluid_chunk_count(liquid.positions.size())));
    message.spacing(liquid.spacing);
    const std::size_t first = which * fluid_chunk_particles;
    const std::size_t count = std::min(fluid_chunk_particles, liquid.positions.size() - first);
    encode_positions({liquid.lower, liquid.upper}, liquid.positions.subspan(first, count), message);
}

bool decode_fluid_chunk(const eti::msg::FluidState& message, float farthest, std::vector<Vec3f>& positions) {
    // Written so that NaN fails.
    return message.spacing() > 0.0f && message.spacing() <= largest_spacing &&
           message.chunks() <= max_fluid_chunks && message.chunk() < message.chunks() &&
           decode_positions(message, farthest, positions);
}

}  // namespace eti::bus
