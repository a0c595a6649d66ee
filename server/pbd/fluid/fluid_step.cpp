// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "server/parallel/loops.hpp"
#include "server/pbd/fluid/fluid.hpp"
#include "server/pbd/fluid/fluid_solid.hpp"
#include "server/pbd/lanes.hpp"

namespace eti::pbd {

namespace {

// Damping of the Jacobi step. With 1, checkerboard patterns of pressure grow.
constexpr float jacobi_step = 0.5f;
// Fraction of the last substep's pressure with which iterations start.
constexpr float kept_pressure = 0.8f;
// Maximum compression corrected per substep. Particles emitted into others, or pressed together, would burst
// apart if all of it were corrected at once.
constexpr float max_excess = 0.05f;

/// Raises the velocity component towards the tip to that of the sink, within its reach.
Vec3f drawn_by_suction(const Vec3f& velocity, const Vec3f& position, const FluidSuction& suction) {
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

void Fluid::predict(float dt, const Vec3f& gravity, const FluidSurroundings& surroundings) {
    const float per_dt = 1.0f / dt;
    parallel::for_each(count(), grain, [&](std::size_t i) {
        if (rest_[i].awake == 0) {
            return;
        }
        Vec3f velocity = velocity_[i] + dt * gravity;
        for (const FluidSuction& suction : surroundings.suctions) {
            velocity = drawn_by_suction(velocity, position_[i], suction);
        }
        velocity = clamped_to_length(velocity, settings_.max_speed);
        Vec3f predicted = position_[i] + dt * velocity;
        // Swept capsules first: later they are planes, without their motion.
        for_capsules(i, surroundings.capsules, [&](const MovingCapsule& capsule) {
            predicted += push_out_of(capsule, position_[i], predicted, 0.5f * settings_.spacing, 0.0f);
        });
        predicted_[i] = predicted;
        velocity_[i] = per_dt * (predicted - position_[i]);
    });
}

/// Sum over neighbours of slope times the four numbers in `of`: two neighbours at a time.
[[gnu::always_inline]] inline void sum_over(const float* slope, const std::uint32_t* neighbour,
                                            std::size_t count, const float* of, Float4& sum) {
    Lanes a{};  // two accumulators hide the latency of additions
    Lanes b{};
    for (std::size_t k = 0; k != count; k += 4) {
        Float4 s;
        Float4 v[4];
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

/// Dot product of the first three numbers. By lanes: a vector written by component and read at once stalls
/// the processor.
[[gnu::always_inline]] inline float dot(const Float4& a, const Float4& b) {
    const Float4 product = a * b;
    return product[0] + product[1] + product[2];
}

[[gnu::always_inline]] inline void load(const Eigen::Vector4f& from, Float4& to) {
    std::memcpy(&to, from.data(), sizeof to);
}

[[gnu::always_inline]] inline void Fluid::move(std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k != end; ++k) {
        const std::uint32_t i = awake_[k];
        // sum_j m_j s_ij (x_i - x_j); the last number is sum_j m_j s_ij.
        Float4 sum;
        sum_over(&slope_[first_pair_[i]], &neighbour_[first_pair_[i]], neighbours_[i], push_.front().data(),
                 sum);
        Float4 local;
        Float4 own;
        Float4 to;
        load(local_[i], local);
        load(own_gradient_[i], own);
        load(offset_[i], to);
        to = to - multiplier_[i] * own - sum[3] * local + sum;
        for (std::size_t w = max_walls * i; w < max_walls * (i + 1); ++w) {
            const Wall& wall = wall_[w];
            if (wall.near) {
                Float4 normal;
                load(wall.normal, normal);
                to -= std::min(wall.gap + dot(normal, to), 0.0f) * normal;
            }
        }
        const Float4 product = Float4{} + dot(local, to);
        to = __builtin_shufflevector(to, product, 0, 1, 2, 4);
        std::memcpy(displacement_[i].data(), &to, sizeof to);
    }
}

[[gnu::always_inline]] inline void Fluid::update_pressure(std::size_t begin, std::size_t end,
                                                          float relaxation) {
    for (std::size_t k = begin; k != end; ++k) {
        const std::uint32_t i = awake_[k];
        // own gradient . d_i - sum_j s_ij (x_i - x_j) . d_j; the last number is sum_j s_ij x_j . d_j.
        Float4 sum;
        sum_over(&slope_[first_pair_[i]], &neighbour_[first_pair_[i]], neighbours_[i],
                 displacement_.front().data(), sum);
        Float4 local;
        Float4 own;
        Float4 moved;
        load(local_[i], local);
        load(own_gradient_[i], own);
        load(displacement_[i], moved);
        const Float4 parts = own * moved - local * sum;
        const float compression = (parts[0] + parts[1]) + (parts[2] + sum[3]);
        const float excess =
            std::min(compression_[i], max_excess) + compression - relaxation * multiplier_[i];
        // A liquid does not pull; attraction is the cohesion's.
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
[[gnu::target("avx2")]] void Fluid::update_pressure_avx2(std::size_t begin, std::size_t end,
                                                         float relaxation) {
    update_pressure(begin, end, relaxation);
}
#else
void Fluid::move_avx2(std::size_t begin, std::size_t end) {
    move(begin, end);
}
void Fluid::update_pressure_avx2(std::size_t begin, std::size_t end, float relaxation) {
    update_pressure(begin, end, relaxation);
}
#endif

void Fluid::step(float dt, const Vec3f& gravity, const FluidSurroundings& surroundings) {
    emit(dt);
    find_capsules(position_, dt, surroundings.capsules);
    if (!wake(dt, gravity, surroundings)) {
        return;
    }
    // At equal pressure, multipliers scale with dt^2.
    const float scale = kept_pressure * dt * dt / (dt_ * dt_);
    dt_ = dt;
    predict(dt, gravity, surroundings);
    remove(surroundings);
    sort();
    find_capsules(predicted_, dt, surroundings.capsules);
    collect(dt, scale, surroundings);
    const float relaxation = 1.0f / (settings_.sound_speed * settings_.sound_speed * dt * dt);
    const auto move_all = [&](std::size_t begin, std::size_t end) {
        avx2_ ? move_avx2(begin, end) : move(begin, end);
    };
    parallel::for_ranges(awake_.size(), grain, move_all);
    for (int k = 0; k < settings_.iterations; ++k) {
        parallel::for_ranges(awake_.size(), grain, [&](std::size_t begin, std::size_t end) {
            avx2_ ? update_pressure_avx2(begin, end, relaxation) : update_pressure(begin, end, relaxation);
        });
        parallel::for_ranges(awake_.size(), grain, move_all);
    }
    finish(dt, surroundings);
    settle(dt, surroundings);
}

}  // namespace eti::pbd
