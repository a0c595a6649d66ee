// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/fluid_state.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/bus/convert.hpp"

namespace eti::bus {

namespace {

constexpr float steps = 65535.0f;
constexpr float largest_spacing = 10e-3f;  // [m]

Vec3f vector_of(const eti::msg::Vec3& v) {
    return {v.x(), v.y(), v.z()};
}

}  // namespace

std::size_t fluid_chunk_count(std::size_t particles) {
    return std::max<std::size_t>(1, (particles + fluid_chunk_particles - 1) / fluid_chunk_particles);
}

void put_fluid_chunk(const Liquid& liquid, std::size_t which, eti::msg::FluidState& message) {
    message.chunk(static_cast<std::uint16_t>(which));
    message.chunks(static_cast<std::uint16_t>(fluid_chunk_count(liquid.positions.size())));
    message.lower(to_msg(liquid.lower));
    message.upper(to_msg(liquid.upper));
    message.spacing(liquid.spacing);
    message.places().clear();
    const std::size_t first = which * fluid_chunk_particles;
    const std::size_t end = std::min(first + fluid_chunk_particles, liquid.positions.size());
    const Vec3f scale = steps * (liquid.upper - liquid.lower).cwiseInverse();
    for (std::size_t i = first; i < end; ++i) {
        const Vec3f place = (liquid.positions[i] - liquid.lower).cwiseProduct(scale);
        for (int axis = 0; axis < 3; ++axis) {
            message.places().push_back(
                static_cast<std::uint16_t>(std::lround(std::clamp(place[axis], 0.0f, steps))));
        }
    }
}

bool take_fluid_chunk(const eti::msg::FluidState& message, float farthest, std::vector<Vec3f>& positions) {
    const Vec3f lower = vector_of(message.lower());
    const Vec3f upper = vector_of(message.upper());
    // Written so that NaN fails.
    const bool proper = (lower.array() >= -farthest).all() && (upper.array() <= farthest).all() &&
                        (lower.array() < upper.array()).all() && message.spacing() > 0.0f &&
                        message.spacing() <= largest_spacing && message.places().size() % 3 == 0 &&
                        message.places().size() <= 3 * fluid_chunk_particles &&
                        message.chunks() <= most_fluid_chunks && message.chunk() < message.chunks();
    if (!proper) {
        return false;
    }
    const Vec3f scale = (upper - lower) / steps;
    const auto& places = message.places();
    for (std::size_t i = 0; i < places.size(); i += 3) {
        const Vec3f place(places[i], places[i + 1], places[i + 2]);
        positions.push_back(lower + place.cwiseProduct(scale));
    }
    return true;
}

}  // namespace eti::bus
