// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/give_way.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/smoothstep.hpp"
#include "common/math/units.hpp"

namespace eti {

namespace {

constexpr float lip = 0.8e-3f;  // [m], height of the tip's

}  // namespace

float BladePlate::width(float along) const {
    return wide + (narrow - wide) * smoothstep(0.3f * length, 0.8f * length, along);
}

float BladePlate::height(float along) const {
    return high + (low - high) * smoothstep(0.35f * length, 0.65f * length, along) +
           lip * smoothstep(length - 8e-3f, length, along);
}

BladePlate plate_of(const Laryngoscope& scope) {
    const bool small = scope.blade == Blade::miller_0;
    return {.length = scope.blade_length,
            .wide = (small ? 8.0f : 10.0f) * millimetre,
            .narrow = (small ? 6.0f : 7.0f) * millimetre,
            .high = scope.capsules[1].radius,
            .low = scope.capsules[2].radius,
            .crown = 1.2f * millimetre};
}

bool GiveWay::moves(const Vec3f& centre, float radius) const {
    const float highest = std::max(plate.high, plate.low) + lip + clearance + softness;
    const float lowest = std::min(plate.high, plate.low) - plate.crown + clearance - deepest - release;
    return std::fabs(centre.x()) - radius < 0.5f * std::max(plate.wide, plate.narrow) + beside &&
           centre.z() + radius > heel && centre.z() - radius < plate.length + beside &&
           centre.y() - radius < highest && centre.y() + radius > lowest;
}

Vec3f GiveWay::operator()(const Vec3f& point) const {
    const float half = 0.5f * plate.width(point.z());
    const float across = std::fabs(point.x());
    const float on_plate = (1.0f - smoothstep(half, half + beside, across)) *
                           smoothstep(heel, heel + beside, point.z()) *
                           (1.0f - smoothstep(plate.length, plate.length + beside, point.z()));
    const float edge = std::min(across / half, 1.0f);
    const float face = plate.height(point.z()) - plate.crown * 2.0f * half / plate.wide * edge * edge;
    const float in = face + clearance - point.y();
    const float deeper = std::clamp(in + softness, 0.0f, 2.0f * softness);
    const float out = in > softness ? in : deeper * deeper / (4.0f * softness);
    return point + Vec3f(0.0f, on_plate * out * (1.0f - smoothstep(deepest, deepest + release, in)), 0.0f);
}

bool PlacedGiveWay::may_move(const Vec3f& centre, float radius) const {
    return give_way.moves(tool.inverse() * centre, radius);
}

}  // namespace eti
