// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/codec/quantised_positions.hpp"

#include <algorithm>
#include <cmath>

namespace eti::bus {

namespace {

constexpr float steps = 65535.0f;
// Avoids division by zero for a flat box. Half a step of this edge is below float resolution.
constexpr float shortest_edge = 1e-6f;  // [m]

}  // namespace

Box box_around(std::span<const Vec3f> positions) {
    Box box{positions.front(), positions.front()};
    for (const Vec3f& p : positions) {
        box.lower = box.lower.cwiseMin(p);
        box.upper = box.upper.cwiseMax(p);
    }
    box.upper = box.upper.cwiseMax(box.lower + Vec3f::Constant(shortest_edge));
    return box;
}

void quantise_positions(const Box& box, std::span<const Vec3f> positions,
                        std::vector<std::uint16_t>& places) {
    places.clear();
    const Vec3f scale = steps * (box.upper - box.lower).cwiseInverse();
    for (const Vec3f& p : positions) {
        const Vec3f place = (p - box.lower).cwiseProduct(scale);
        for (int axis = 0; axis < 3; ++axis) {
            places.push_back(static_cast<std::uint16_t>(std::lround(std::clamp(place[axis], 0.0f, steps))));
        }
    }
}

bool dequantise_positions(const Box& box, std::span<const std::uint16_t> places, float farthest,
                          std::vector<Vec3f>& positions) {
    // Written so that NaN fails.
    const bool proper = (box.lower.array() >= -farthest).all() && (box.upper.array() <= farthest).all() &&
                        (box.lower.array() < box.upper.array()).all() && places.size() % 3 == 0 &&
                        places.size() <= 3 * chunk_positions;
    if (!proper) {
        return false;
    }
    const Vec3f scale = (box.upper - box.lower) / steps;
    for (std::size_t i = 0; i < places.size(); i += 3) {
        const Vec3f place(places[i], places[i + 1], places[i + 2]);
        positions.push_back(box.lower + place.cwiseProduct(scale));
    }
    return true;
}

}  // namespace eti::bus
