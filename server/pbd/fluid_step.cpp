// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "server/parallel/loops.hpp"
#include "server/pbd/fluid.hpp"
#include "server/pbd/lanes.hpp"

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
    parallel::for_each(count(), grain, [&](std::size_t i) {
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

/// Sum over neighbours of their slope times their four numbers in `of`: two neighbours at a time.
[[gnu::always_inline]] inline void sum_over(const float* slope, const std::uint32_t* neighbour,
                                            std::size_t count, const float* of, Four& sum) {
    Lanes a{};  // two sums, because an addition takes as long as several of them can be started
    Lanes b{};
    for (std::size_t k = 0; k != count; k += 4) {
        Four s;
        Four v[4];
        std::memcpy(&s, slope + k, sizeof s);
        for (std::size_t l = 0; l < 4; ++l) {
            std::memcpy(&v[l], of + neighbour[k + l], sizeof v[l]);
        }
        a += __builtin_shufflevector(s, s, 0, 0, 0, 0, 1, 1, 1, 1) *
             __builtin_shufflevector(v[0], v[1], 0, 1, 2, 3, 4, 5, 6, 7);
        b += __builtin_shufflevector(s, s, 2, 2, 2, 2, 3, 3, 3, 3) *
             __builtin_shufflevector(v[2], v[3], 0, 1, 2, 3, 4, 5, 6, 7);
    }
    a += b;
    sum = __builtin_shufflevector(a, a, 0, 1, 2, 3) + __builtin_shufflevector(a, a, 4, 5, 6, 7);
}

/// The first three numbers' product. By lanes: a vector written number by number and read at once stalls the
/// processor.
[[gnu::always_inline]] inline float dot(const Four& a, const Four& b) {
    const Four product = a * b;
    return product[0] + product[1] + product[2];
}

[[gnu::always_inline]] inline void load(const Eigen::Vector4f& from, Four& to) {
    std::memcpy(&to, from.data(), sizeof to);
}

[[gnu::always_inline]] inline void Fluid::move(std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i != end; ++i) {
        // sum_j m_j s_ij (x_i - x_j); the last number is sum_j m_j s_ij.
        Four sum;
        sum_over(&slope_[first_pair_[i]], &neighbour_[first_pair_[i]], neighbours_[i], push_.front().data(),
                 sum);
        Four local;
        Four own;
        Four to;
        load(local_[i], local);
        load(own_gradient_[i], own);
        load(offset_[i], to);
        to = to - multiplier_[i] * own - sum[3] * local + sum;
        for (std::size_t w = most_walls * i; w < most_walls * (i + 1); ++w) {
            const Wall& wall = wall_[w];
            if (wall.near) {
                Four normal;
                load(wall.normal, normal);
                to -= std::min(wall.gap + dot(normal, to), 0.0f) * normal;
            }
        }
        const Four product = Four{} + dot(local, to);
        to = __builtin_shufflevector(to, product, 0, 1, 2, 4);
        std::memcpy(displacement_[i].data(), &to, sizeof to);
    }
}

[[gnu::always_inline]] inline void Fluid::raise_pressure(std::size_t begin, std::size_t end,
                                                         float relaxation) {
    for (std::size_t i = begin; i != end; ++i) {
        // own gradient . d_i - sum_j s_ij (x_i - x_j) . d_j; the last number is sum_j s_ij x_j . d_j.
        Four sum;
        sum_over(&slope_[first_pair_[i]], &neighbour_[first_pair_[i]], neighbours_[i],
                 displacement_.front().data(), sum);
        Four local;
        Four own;
        Four moved;
        load(local_[i], local);
        load(own_gradient_[i], own);
        load(displacement_[i], moved);
        const Four parts = own * moved - local * sum;
        const float compression = (parts[0] + parts[1]) + (parts[2] + sum[3]);
        const float excess =
            std::min(compression_[i], most_excess) + compression - relaxation * multiplier_[i];
        // A liquid does not pull: cohesion does.
        const float multiplier =
            std::max(multiplier_[i] + jacobi_step * excess / (diagonal_[i] + relaxation), 0.0f);
        multiplier_[i] = multiplier;
        local *= multiplier;
        std::memcpy(push_[i].data(), &local, sizeof local);
    }
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void Fluid::move_avx2(std::size_t begin, std::size_t end) {
    move(begin, end);
}
[[gnu::target("avx2")]] void Fluid::raise_pressure_avx2(std::size_t begin, std::size_t end,
                                                        float relaxation) {
    raise_pressure(begin, end, relaxation);
}
#else
void Fluid::move_avx2(std::size_t begin, std::size_t end) {
    move(begin, end);
}
void Fluid::raise_pressure_avx2(std::size_t begin, std::size_t end, float relaxation) {
    raise_pressure(begin, end, relaxation);
}
#endif

void Fluid::finish(float dt, const FluidSurroundings& surroundings) {
    const float radius = 0.5f * settings_.spacing;
    parallel::for_each(count(), grain, [&](std::size_t i) {
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
    parallel::for_each(count(), grain, [&](std::size_t i) { multiplier_[i] *= scale; });
    collect(dt, surroundings);
    const float relaxation = 1.0f / (settings_.sound_speed * settings_.sound_speed * dt * dt);
    const auto move_all = [&](std::size_t begin, std::size_t end) {
        avx2_ ? move_avx2(begin, end) : move(begin, end);
    };
    parallel::for_ranges(count(), grain, move_all);
    for (int k = 0; k < settings_.iterations; ++k) {
        parallel::for_ranges(count(), grain, [&](std::size_t begin, std::size_t end) {
            avx2_ ? raise_pressure_avx2(begin, end, relaxation) : raise_pressure(begin, end, relaxation);
        });
        parallel::for_ranges(count(), grain, move_all);
    }
    finish(dt, surroundings);
}

}  // namespace eti::pbd
