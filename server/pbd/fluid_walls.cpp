// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "server/parallel/loops.hpp"
#include "server/pbd/fluid.hpp"
#include "server/pbd/fluid_solid.hpp"
#include "server/pbd/lanes.hpp"

namespace eti::pbd {

namespace {

// Rounds of pushing out of solid and capsules where both press.
constexpr int final_rounds = 3;
// [spacings], as deep as this in a wall is not worth a push: a few roundings.
constexpr float let_be = 1e-4f;

[[gnu::always_inline]] inline Four four(const Vec3f& v) {
    return Four{v.x(), v.y(), v.z(), 0.0f};
}

[[gnu::always_inline]] inline Four lower_of(const Four& a, const Four& b) {
    return a < b ? a : b;
}

[[gnu::always_inline]] inline Four higher_of(const Four& a, const Four& b) {
    return a > b ? a : b;
}

}  // namespace

FluidSolid::FluidSolid(const DistanceGrid& grid)
    : value_(grid.value.data()),
      origin_(four(grid.origin)),
      per_spacing_(1.0f / grid.spacing),
      last_{static_cast<float>(grid.size[0] - 1), static_cast<float>(grid.size[1] - 1),
            static_cast<float>(grid.size[2] - 1), 0.0f},
      last_cell_{grid.size[0] - 2, grid.size[1] - 2, grid.size[2] - 2, 0},
      row_(grid.size[0]),
      layer_(grid.size[0] * grid.size[1]) {}

FluidSolid::Sample FluidSolid::at(const Vec3f& point) const {
    Four place = (four(point) - origin_) * per_spacing_;
    // The comparison order sends NaN to zero, so that no index leaves the grid.
    place = place > 0.0f ? place : Four{};
    place = lower_of(place, last_);
    Whole base = __builtin_convertvector(place, Whole);
    base = base < last_cell_ ? base : last_cell_;
    const Four t = place - __builtin_convertvector(base, Four);
    const float* const corner =
        value_ + base[0] + base[1] * row_ + static_cast<std::ptrdiff_t>(base[2]) * layer_;
    Four low;
    Four high;
    std::memcpy(&low, corner, 8);
    std::memcpy(reinterpret_cast<char*>(&low) + 8, corner + row_, 8);
    std::memcpy(&high, corner + layer_, 8);
    std::memcpy(reinterpret_cast<char*>(&high) + 8, corner + layer_ + row_, 8);
    // Along z, then y, then x; beside the values what they change by.
    const Four rise_z = high - low;
    const Four along_z = low + t[2] * rise_z;
    const Four near_y = __builtin_shufflevector(along_z, rise_z, 0, 1, 4, 5);
    const Four rise_y = __builtin_shufflevector(along_z, rise_z, 2, 3, 6, 7) - near_y;
    const Four along_y = near_y + t[1] * rise_y;
    const Four near_x = __builtin_shufflevector(along_y, rise_y, 0, 4, 2, 0);
    const Four rise_x = __builtin_shufflevector(along_y, rise_y, 1, 5, 3, 1) - near_x;
    const Four along_x = near_x + t[0] * rise_x;
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
        // Backward Euler, so that no viscosity can turn the slip round.
        const float rate = 10.0f * settings_.wall_viscosity * terms.drag * dt;
        offset -= rate / (1.0f + rate) * (slip - along * normal) +
                  dt * dt * steep * wall_attraction_ * terms.adhesion * normal;
    };
    Wall* wall = &wall_[most_walls * i];
    wall[0].near = wall[1].near = false;
    if (solid != nullptr) {
        const FluidSolid::Sample sample = solid->at(predicted_[i]);
        if (sample.distance < kernel_.radius) {
            // The terms' derivative is that of the distance between nodes, which is flat midway in a cleft.
            const float steep = sample.gradient.norm() / solid->spacing();
            meet(wall[0], sample.distance, sample.normal(), steep, Vec3f::Zero());
        }
    }
    if (capsules_near_[i / crowd] != 0 || capsules.size() > most_sorted) {
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
        Four low, high;
    };
    const std::size_t sorted = std::min(capsules.size(), most_sorted);
    std::array<Box, most_sorted> box;
    // A capsule also holds back what it swept over: the box is about all of its way.
    const float way = settings_.max_speed * dt + std::max(settings_.spacing, kernel_.radius);
    for (std::size_t k = 0; k < sorted; ++k) {
        const MovingCapsule& c = capsules[k];
        const Four margin = Four{1.0f, 1.0f, 1.0f, 0.0f} * (2.0f * c.radius + way);
        box[k] = {
            lower_of(lower_of(four(c.a), four(c.b)), lower_of(four(c.a_before), four(c.b_before))) - margin,
            higher_of(higher_of(four(c.a), four(c.b)), higher_of(four(c.a_before), four(c.b_before))) +
                margin};
    }
    for (std::size_t first = 0; first < points.size(); first += crowd) {
        Four low = four(points[first]);
        Four high = low;
        for (std::size_t i = first + 1; i < std::min(first + crowd, points.size()); ++i) {
            const Four p = four(points[i]);
            low = lower_of(low, p);
            high = higher_of(high, p);
        }
        std::uint64_t near = 0;
        for (std::size_t k = 0; k < sorted; ++k) {
            const auto apart = (box[k].low > high) | (box[k].high < low);
            near |= static_cast<std::uint64_t>((apart[0] | apart[1] | apart[2]) == 0 ? 1 : 0) << k;
        }
        capsules_near_[first / crowd] = near;
    }
}

void Fluid::finish(float dt, const FluidSurroundings& surroundings) {
    const float radius = 0.5f * settings_.spacing;
    const float touching = radius - let_be * settings_.spacing;
    const float per_dt = 1.0f / dt;
    const std::optional<FluidSolid> solid = solid_of(surroundings);
    parallel::for_each(awake_.size(), grain, [&](std::size_t k) {
        const std::uint32_t i = awake_[k];
        // Relative to the prediction: the difference of two positions has fewer digits.
        Vec3f move = displacement_[i].head<3>();
        Vec3f to = predicted_[i] + move;
        // No wall comes nearer by more than the particle moved; an interpolated distance may by 1.7 times
        // that.
        float room = kernel_.radius - radius;
        for (std::size_t w = most_walls * i; w < most_walls * (i + 1); ++w) {
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
        // The solid takes what goes into it. What the way out of it was longer than by its plane is no speed:
        // with it, liquid in clefts never comes to rest.
        velocity -= std::min(velocity.dot(out), 0.0f) * out;
        // Coming out of an old overlap gives no speed (pre-stabilisation: Macklin et al. 2014, section 4.4).
        for (std::size_t w = most_walls * i; w < most_walls * (i + 1); ++w) {
            const Wall& wall = wall_[w];
            if (wall.near && wall.overlap > 0.0f) {
                const Vec3f normal = wall.normal.head<3>();
                const float leaving = std::max(velocity.dot(normal) - wall.speed, 0.0f);
                velocity -= std::min(leaving, per_dt * wall.overlap) * normal;
            }
        }
        velocity_[i] = limited(velocity, settings_.max_speed);
        predicted_[i] = to;
        position_[i] = to;
    });
}

}  // namespace eti::pbd
