// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "server/parallel/loops.hpp"
#include "server/pbd/fluid/fluid.hpp"
#include "server/pbd/fluid/fluid_solid.hpp"
#include "server/pbd/lanes.hpp"

namespace eti::pbd {

namespace {

// Iterations of pushing out of solid and capsules where both press.
constexpr int final_rounds = 3;
// [spacings], tolerated penetration: a few rounding errors.
constexpr float let_be = 1e-4f;

[[gnu::always_inline]] inline Float4 load_float4(const Vec3f& v) {
    return Float4{v.x(), v.y(), v.z(), 0.0f};
}

[[gnu::always_inline]] inline Float4 lower_of(const Float4& a, const Float4& b) {
    return a < b ? a : b;
}

[[gnu::always_inline]] inline Float4 higher_of(const Float4& a, const Float4& b) {
    return a > b ? a : b;
}

}  // namespace

FluidSolid::FluidSolid(const DistanceGrid& grid)
    : value_(grid.value.data()),
      origin_(load_float4(grid.origin)),
      per_spacing_(1.0f / grid.spacing),
      last_{static_cast<float>(grid.size[0] - 1), static_cast<float>(grid.size[1] - 1),
            static_cast<float>(grid.size[2] - 1), 0.0f},
      last_cell_{grid.size[0] - 2, grid.size[1] - 2, grid.size[2] - 2, 0},
      row_(grid.size[0]),
      layer_(grid.size[0] * grid.size[1]) {}

FluidSolid::Sample FluidSolid::at(const Vec3f& point) const {
    Float4 place = (load_float4(point) - origin_) * per_spacing_;
    // The order of comparison maps NaN to zero, so that indices stay in the grid.
    place = place > 0.0f ? place : Float4{};
    place = lower_of(place, last_);
    Whole base = __builtin_convertvector(place, Whole);
    base = base < last_cell_ ? base : last_cell_;
    const Float4 t = place - __builtin_convertvector(base, Float4);
    const float* const corner =
        value_ + base[0] + base[1] * row_ + static_cast<std::ptrdiff_t>(base[2]) * layer_;
    Float4 low;
    Float4 high;
    std::memcpy(&low, corner, 8);
    std::memcpy(reinterpret_cast<char*>(&low) + 8, corner + row_, 8);
    std::memcpy(&high, corner + layer_, 8);
    std::memcpy(reinterpret_cast<char*>(&high) + 8, corner + layer_ + row_, 8);
    // Interpolates along z, then y, then x; values and differences side by side.
    const Float4 rise_z = high - low;
    const Float4 along_z = low + t[2] * rise_z;
    const Float4 near_y = __builtin_shufflevector(along_z, rise_z, 0, 1, 4, 5);
    const Float4 rise_y = __builtin_shufflevector(along_z, rise_z, 2, 3, 6, 7) - near_y;
    const Float4 along_y = near_y + t[1] * rise_y;
    const Float4 near_x = __builtin_shufflevector(along_y, rise_y, 0, 4, 2, 0);
    const Float4 rise_x = __builtin_shufflevector(along_y, rise_y, 1, 5, 3, 1) - near_x;
    const Float4 along_x = near_x + t[0] * rise_x;
    return {along_x[0], Vec3f(rise_x[0], along_x[1], along_x[2])};
}

Fluid::Nearest Fluid::nearest_capsule(std::size_t i, const Vec3f& point,
                                      std::span<const MovingCapsule> capsules) const {
    Nearest nearest;
    nearest.gap = kernel_.radius;
    for_capsules(i, capsules, [&](const MovingCapsule& capsule) {
        const float t = closest_on_segment(capsule.a, capsule.b, point);
        const Vec3f axis = capsule.a + t * (capsule.b - capsule.a);
        const float gap = (point - axis).norm() - capsule.radius;
        if (gap < nearest.gap) {
            nearest = {&capsule, gap, point - axis,
                       axis - (capsule.a_before + t * (capsule.b_before - capsule.a_before))};
        }
    });
    return nearest;
}

void Fluid::find_walls(std::size_t i, float dt, const FluidSolid* solid,
                       std::span<const MovingCapsule> capsules) {
    const float radius = 0.5f * settings_.spacing;
    Vec3f offset = Vec3f::Zero();
    Vec3f gradient = Vec3f::Zero();
    float density = 0.0f;
    const auto meet = [&](Wall& wall, float distance, const Vec3f& normal, float steep, const Vec3f& motion) {
        const WallTerms terms = wall_table_.at(distance);
        density += terms.density;
        gradient += steep * terms.gradient * normal;
        const Vec3f slip = dt * velocity_[i] - motion;
        const float along = slip.dot(normal);
        const float gap = distance - radius;
        wall = {Vec4f(normal.x(), normal.y(), normal.z(), 0.0f), gap, std::max(along - gap, 0.0f),
                motion.dot(normal) / dt, true};
        // Backward Euler, so that no viscosity can reverse the slip.
        const float rate = 10.0f * settings_.wall_viscosity * terms.drag * dt;
        offset -= rate / (1.0f + rate) * (slip - along * normal) +
                  dt * dt * steep * wall_attraction_ * terms.adhesion * normal;
    };
    Wall* wall = &wall_[max_walls * i];
    wall[0].near = wall[1].near = false;
    if (solid != nullptr) {
        const FluidSolid::Sample sample = solid->at(predicted_[i]);
        if (sample.distance < kernel_.radius) {
            // The derivative of the terms uses the interpolated gradient, which vanishes midway in a cleft.
            const float steep = sample.gradient.norm() / solid->spacing();
            meet(wall[0], sample.distance, sample.normal(), steep, Vec3f::Zero());
        }
    }
    if (capsules_near_[i / capsule_group] != 0 || capsules.size() > max_sorted) {
        const Nearest nearest = nearest_capsule(i, predicted_[i], capsules);
        if (nearest.capsule != nullptr) {
            meet(wall[1], nearest.gap, nearest.apart.normalized(), 1.0f, nearest.motion);
        }
    }
    offset_[i] = Vec4f(offset.x(), offset.y(), offset.z(), 0.0f);
    compression_[i] = density;
    own_gradient_[i] = Vec4f(gradient.x(), gradient.y(), gradient.z(), 0.0f);
}

void Fluid::find_capsules(std::span<const Vec3f> points, float dt, std::span<const MovingCapsule> capsules) {
    struct Box {
        Float4 low, high;
    };
    const std::size_t sorted = std::min(capsules.size(), max_sorted);
    std::array<Box, max_sorted> box;
    // The box covers the capsule's whole sweep, because a capsule also stops particles that it sweeps over.
    const float way = settings_.max_speed * dt + std::max(settings_.spacing, kernel_.radius);
    for (std::size_t k = 0; k < sorted; ++k) {
        const MovingCapsule& c = capsules[k];
        const Float4 margin = Float4{1.0f, 1.0f, 1.0f, 0.0f} * (2.0f * c.radius + way);
        box[k] = {lower_of(lower_of(load_float4(c.a), load_float4(c.b)),
                           lower_of(load_float4(c.a_before), load_float4(c.b_before))) -
                      margin,
                  higher_of(higher_of(load_float4(c.a), load_float4(c.b)),
                            higher_of(load_float4(c.a_before), load_float4(c.b_before))) +
                      margin};
    }
    for (std::size_t first = 0; first < points.size(); first += capsule_group) {
        Float4 low = load_float4(points[first]);
        Float4 high = low;
        for (std::size_t i = first + 1; i < std::min(first + capsule_group, points.size()); ++i) {
            const Float4 p = load_float4(points[i]);
            low = lower_of(low, p);
            high = higher_of(high, p);
        }
        std::uint64_t near = 0;
        for (std::size_t k = 0; k < sorted; ++k) {
            const auto apart = (box[k].low > high) | (box[k].high < low);
            near |= static_cast<std::uint64_t>((apart[0] | apart[1] | apart[2]) == 0 ? 1 : 0) << k;
        }
        capsules_near_[first / capsule_group] = near;
    }
}

void Fluid::finish(float dt, const FluidSurroundings& surroundings) {
    const float radius = 0.5f * settings_.spacing;
    const float touching = radius - let_be * settings_.spacing;
    const float per_dt = 1.0f / dt;
    const std::optional<FluidSolid> solid = solid_of(surroundings);
    parallel::for_each(awake_.size(), grain, [&](std::size_t k) {
        const std::uint32_t i = awake_[k];
        // Relative to the prediction: the difference of two positions loses precision.
        Vec3f move = displacement_[i].head<3>();
        Vec3f to = predicted_[i] + move;
        // A wall's distance changes by at most the particle's displacement; an interpolated one by 1.7 times
        // that.
        float room = kernel_.radius - radius;
        for (std::size_t w = max_walls * i; w < max_walls * (i + 1); ++w) {
            room = wall_[w].near ? std::min(room, wall_[w].gap) : room;
        }
        const bool tight = room < 0.0f || 1.75f * 1.75f * move.squaredNorm() > room * room;
        Vec3f out = Vec3f::Zero();
        for (int round = 0; tight && round < final_rounds; ++round) {
            Vec3f push = Vec3f::Zero();
            for_capsules(i, surroundings.capsules, [&](const MovingCapsule& capsule) {
                push += push_out_of(capsule, position_[i], to + push, radius, 0.0f);
            });
            move += push;
            if (solid.has_value()) {
                const FluidSolid::Sample sample = solid->at(to + push);
                if (sample.distance < touching) {
                    out = sample.normal();
                    push += (radius - sample.distance) * out;
                }
            }
            if (push.isZero(0.0f)) {
                break;
            }
            to += push;
        }
        Vec3f velocity = velocity_[i] + per_dt * move;
        // The solid absorbs the normal velocity. Push-out beyond the linearised plane adds no velocity;
        // otherwise liquid in clefts would never come to rest.
        velocity -= std::min(velocity.dot(out), 0.0f) * out;
        // Resolving earlier penetration adds no velocity (pre-stabilisation: Macklin et al. 2014, section
        // 4.4).
        for (std::size_t w = max_walls * i; w < max_walls * (i + 1); ++w) {
            const Wall& wall = wall_[w];
            if (wall.near && wall.overlap > 0.0f) {
                const Vec3f normal = wall.normal.head<3>();
                const float leaving = std::max(velocity.dot(normal) - wall.speed, 0.0f);
                velocity -= std::min(leaving, per_dt * wall.overlap) * normal;
            }
        }
        velocity_[i] = clamped_to_length(velocity, settings_.max_speed);
        predicted_[i] = to;
        position_[i] = to;
    });
}

}  // namespace eti::pbd
