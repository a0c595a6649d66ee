// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/pbd/fluid.hpp"
#include "server/pbd/ranges.hpp"

namespace eti::pbd {

namespace {

// Part of a full Jacobi step. Steps of 1 let checkerboards of pressure grow.
constexpr float jacobi_step = 0.5f;
// Part of the last substep's pressure that the iterations start from. All of it makes the liquid bounce on
// itself (pressure lags by a few substeps); none of it doubles the compression at depth.
constexpr float kept_pressure = 0.5f;
// Compression that one substep sets out to remove. Particles that were emitted into others, or pressed
// together, would burst apart if all of it went at once.
constexpr float most_excess = 0.05f;
// Rounds of pushing out of solid and capsules where both press.
constexpr int final_rounds = 3;

/// Not longer than `limit`.
Vec3f limited(const Vec3f& v, float limit) {
    const float squared = v.squaredNorm();
    return squared > limit * limit ? Vec3f(v * (limit / std::sqrt(squared))) : v;
}

/// The velocity with its part towards the tip raised to that of the sink, as far as it reaches.
Vec3f drawn(const Vec3f& velocity, const Vec3f& position, const FluidSuction& suction) {
    const Vec3f towards = suction.tip - position;
    const float distance = towards.norm();
    if (!(suction.strength > 0.0f) || distance >= suction.reach || distance < suction.radius) {
        return velocity;
    }
    const Vec3f direction = towards / distance;
    const float speed =
        suction.strength * suction.flow / (4.0f * std::numbers::pi_v<float> * distance * distance);
    return velocity + std::max(speed - velocity.dot(direction), 0.0f) * direction;
}

}  // namespace

void Fluid::step(float dt, const Vec3f& gravity, const FluidSurroundings& surroundings) {
    // Multipliers go with dt^2 at equal pressure.
    const float scale = kept_pressure * dt * dt / (dt_ * dt_);
    dt_ = dt;
    emit(dt);
    find_capsules(position_, dt, surroundings.capsules);
    predict(dt, gravity, surroundings);
    remove(surroundings);
    sort();
    find_capsules(predicted_, dt, surroundings.capsules);
    for_each(count(), grain, [&](std::size_t i) { multiplier_[i] *= scale; });
    collect(dt, surroundings);
    const float relaxation = 1.0f / (settings_.sound_speed * settings_.sound_speed * dt * dt);
    for_each(count(), grain, [&](std::size_t i) { move(i); });
    for (int k = 0; k < settings_.iterations; ++k) {
        for_each(count(), grain, [&](std::size_t i) { raise_pressure(i, relaxation); });
        for_each(count(), grain, [&](std::size_t i) { move(i); });
    }
    finish(dt, surroundings);
}

void Fluid::find_capsules(std::span<const Vec3f> points, float dt, std::span<const MovingCapsule> capsules) {
    const std::size_t sorted = std::min(capsules.size(), most_sorted);
    // A capsule also holds back what it swept over: the box below is about all of its way.
    const float way = settings_.max_speed * dt + std::max(settings_.spacing, kernel_.radius);
    for (std::size_t first = 0; first < points.size(); first += crowd) {
        Eigen::AlignedBox3f box;
        for (std::size_t i = first; i < std::min(first + crowd, points.size()); ++i) {
            box.extend(points[i]);
        }
        std::uint64_t near = 0;
        for (std::size_t k = 0; k < sorted; ++k) {
            const MovingCapsule& c = capsules[k];
            const Vec3f margin = Vec3f::Constant(2.0f * c.radius + way);
            const Vec3f low = c.a.cwiseMin(c.b).cwiseMin(c.a_before.cwiseMin(c.b_before)) - margin;
            const Vec3f high = c.a.cwiseMax(c.b).cwiseMax(c.a_before.cwiseMax(c.b_before)) + margin;
            const bool apart =
                (low.array() > box.max().array()).any() || (high.array() < box.min().array()).any();
            near |= static_cast<std::uint64_t>(apart ? 0 : 1) << k;
        }
        capsules_near_[first / crowd] = near;
    }
}

void Fluid::predict(float dt, const Vec3f& gravity, const FluidSurroundings& surroundings) {
    for_each(count(), grain, [&](std::size_t i) {
        Vec3f velocity = velocity_[i] + dt * gravity;
        for (const FluidSuction& suction : surroundings.suctions) {
            velocity = drawn(velocity, position_[i], suction);
        }
        velocity = limited(velocity, settings_.max_speed);
        Vec3f predicted = position_[i] + dt * velocity;
        // Swept capsules first: afterwards they are planes, which have forgotten from where they came.
        for_capsules(i, surroundings.capsules, [&](const MovingCapsule& capsule) {
            predicted += push_out_of(capsule, position_[i], predicted, 0.5f * settings_.spacing, 0.0f);
        });
        predicted_[i] = predicted;
        velocity_[i] = (predicted - position_[i]) / dt;
    });
}

void Fluid::move(std::size_t i) {
    const std::uint32_t* const neighbour = &neighbour_[first_pair_[i]];
    const Vec4f* const gradient = &gradient_[first_pair_[i]];
    const std::uint32_t n = neighbours_[i];
    // Four sums, because an addition takes as long as four of them can be started.
    Vec4f a = multiplier_[i] * own_gradient_[i];
    Vec4f b = Vec4f::Zero(), c = Vec4f::Zero(), d = Vec4f::Zero();
    for (std::uint32_t k = 0; k < n; k += 4) {
        a += multiplier_[neighbour[k]] * gradient[k];
        b += multiplier_[neighbour[k + 1]] * gradient[k + 1];
        c += multiplier_[neighbour[k + 2]] * gradient[k + 2];
        d += multiplier_[neighbour[k + 3]] * gradient[k + 3];
    }
    Vec4f to = offset_[i] - ((a + b) + (c + d));
    for (std::size_t w = most_walls * i; w < most_walls * (i + 1); ++w) {
        const Wall& wall = wall_[w];
        if (wall.near) {
            to -= std::min(wall.gap + wall.normal.dot(to), 0.0f) * wall.normal;
        }
    }
    displacement_[i] = to;
}

void Fluid::raise_pressure(std::size_t i, float relaxation) {
    const std::uint32_t* const neighbour = &neighbour_[first_pair_[i]];
    const Vec4f* const gradient = &gradient_[first_pair_[i]];
    const std::uint32_t n = neighbours_[i];
    Vec4f a = own_gradient_[i].cwiseProduct(displacement_[i]);
    Vec4f b = Vec4f::Zero(), c = Vec4f::Zero(), d = Vec4f::Zero();
    for (std::uint32_t k = 0; k < n; k += 4) {
        a -= gradient[k].cwiseProduct(displacement_[neighbour[k]]);
        b -= gradient[k + 1].cwiseProduct(displacement_[neighbour[k + 1]]);
        c -= gradient[k + 2].cwiseProduct(displacement_[neighbour[k + 2]]);
        d -= gradient[k + 3].cwiseProduct(displacement_[neighbour[k + 3]]);
    }
    const float excess =
        std::min(compression_[i], most_excess) + ((a + b) + (c + d)).sum() - relaxation * multiplier_[i];
    // A liquid does not pull: cohesion does.
    multiplier_[i] = std::max(multiplier_[i] + jacobi_step * excess / (diagonal_[i] + relaxation), 0.0f);
}

void Fluid::finish(float dt, const FluidSurroundings& surroundings) {
    const float radius = 0.5f * settings_.spacing;
    for_each(count(), grain, [&](std::size_t i) {
        // Relative to the prediction: the difference of two positions has fewer digits.
        Vec3f move = displacement_[i].head<3>();
        Vec3f to = predicted_[i] + move;
        // No wall comes nearer by more than the particle moved; an interpolated distance may by 1.7 times
        // that.
        float room = kernel_.radius - radius;
        for (std::size_t w = most_walls * i; w < most_walls * (i + 1); ++w) {
            room = wall_[w].near ? std::min(room, wall_[w].gap) : room;
        }
        const bool tight = 1.75f * move.norm() > room;
        for (int round = 0; tight && round < final_rounds; ++round) {
            Vec3f push = Vec3f::Zero();
            for_capsules(i, surroundings.capsules, [&](const MovingCapsule& capsule) {
                push += push_out_of(capsule, position_[i], to + push, radius, 0.0f);
            });
            if (surroundings.solid != nullptr) {
                push += push_out_of(*surroundings.solid, position_[i], to + push, radius, 0.0f);
            }
            if (push.isZero(0.0f)) {
                break;
            }
            to += push;
            move += push;
        }
        Vec3f velocity = velocity_[i] + move / dt;
        // Coming out of an old overlap gives no speed (pre-stabilisation: Macklin et al. 2014, section 4.4).
        for (std::size_t w = most_walls * i; w < most_walls * (i + 1); ++w) {
            const Wall& wall = wall_[w];
            const Vec3f normal = wall.normal.head<3>();
            const float leaving = std::max(velocity.dot(normal) - wall.speed, 0.0f);
            velocity -= std::min(leaving, wall.overlap / dt) * normal;
        }
        velocity_[i] = limited(velocity, settings_.max_speed);
        predicted_[i] = to;
        position_[i] = to;
    });
}

}  // namespace eti::pbd
