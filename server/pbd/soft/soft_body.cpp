// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/soft/soft_body.hpp"

#include <cmath>

#include "server/parallel/loops.hpp"
#include "server/pbd/lanes.hpp"

namespace eti::pbd {

namespace {

constexpr std::size_t soft_body_grain = 4096;  // minimum number of particles per task

static_assert(sizeof(Vec3f) == 3 * sizeof(float));

template <class Body>
void for_awake_ranges(const Particles& particles, const Body& body) {
    for (const auto& run : particles.awake) {
        const std::size_t first = run[0];
        if (first == run[1]) {
            continue;  // no particles
        }
        parallel::for_ranges(run[1] - first, soft_body_grain,
                             [&](std::size_t begin, std::size_t end) { body(first + begin, first + end); });
    }
}

}  // namespace

void SoftBody::enable_sleeping(const std::vector<bool>& mesh, const Sleep::Settings& wanted) {
    std::vector<Constraint::Pair> coupled_pairs;
    for_constraints([&](const Constraint& constraint) {
        coupled_pairs.insert(coupled_pairs.end(), constraint.coupled_pairs().begin(),
                             constraint.coupled_pairs().end());
    });
    sleep.configure(particles, shapes, coupled_pairs, mesh, wanted);
}

void SoftBody::begin_step() {
    for_constraints([&](Constraint& constraint) { constraint.begin_step(particles, sleep); });
    if (sleep.update_awake(particles)) {
        shapes.select(sleep.blocks_asleep(), particles);
        for_constraints([&](Constraint& constraint) { constraint.select(particles); });
    }
}

void SoftBody::end_step() {
    if (sleep.enabled()) {
        sleep.end_step(particles);
    }
}

void SoftBody::predict(float dt, float fraction) {
    Particles& p = particles;
    if (!settings.acceleration.isZero(0.0f)) {
        const Vec3f faster = dt * settings.acceleration;
        for_awake_ranges(p, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                p.velocity[i] += p.inverse_mass[i] > 0.0f ? faster : Vec3f(Vec3f::Zero());
            }
        });
    }
    for_awake_ranges(p, [&](std::size_t begin, std::size_t end) {
        const float* const inverse_mass = p.inverse_mass.data();
        const float* const position = p.position.front().data();
        const float* const velocity = p.velocity.front().data();
        const float* const rest = p.rest.front().data();
        float* const predicted = p.predicted.front().data();
        std::size_t i = begin;
        // Four particles fill three registers.
        for (; i + 4 <= end; i += 4) {
            const Float4 mass = load_float4(inverse_mass + i);
            const Float4 of[3] = {__builtin_shufflevector(mass, mass, 0, 0, 0, 1),
                                  __builtin_shufflevector(mass, mass, 1, 1, 2, 2),
                                  __builtin_shufflevector(mass, mass, 2, 3, 3, 3)};
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t at = 3 * i + 4 * k;
                const Float4 x = load_float4(position + at);
                const Float4 free = dt * load_float4(velocity + at);
                const Float4 held = fraction * (load_float4(rest + at) - x);
                const Float4 to = x + (of[k] > 0.0f ? free : held);
                put(to, predicted + at);
            }
        }
        for (; i < end; ++i) {
            p.predicted[i] = p.inverse_mass[i] > 0.0f
                                 ? Vec3f(p.position[i] + dt * p.velocity[i])
                                 : Vec3f(p.position[i] + fraction * (p.rest[i] - p.position[i]));
        }
    });
}

void SoftBody::project(float dt) {
    if (particles.awake.empty()) {
        return;
    }
    shapes.project(particles, dt);
    for_constraints([&](Constraint& constraint) { constraint.project(particles, dt); });
}

void SoftBody::finish(float dt) {
    Particles& p = particles;
    const float keep = std::exp(-settings.damping * dt) / dt;
    for_awake_ranges(p, [&](std::size_t begin, std::size_t end) {
        const float* __restrict predicted = p.predicted.front().data();
        float* __restrict position = p.position.front().data();
        float* __restrict velocity = p.velocity.front().data();
        for (std::size_t k = 3 * begin; k < 3 * end; ++k) {
            velocity[k] = keep * (predicted[k] - position[k]);
            position[k] = predicted[k];
        }
    });
}

void SoftBody::set_rest() {
    shapes.set_rest(particles);
    for_constraints([&](Constraint& constraint) { constraint.set_rest(particles); });
    sleep.wake_all(particles);
}

void SoftBody::reset() {
    particles.position = particles.rest;
    particles.predicted = particles.rest;
    particles.velocity.assign(particles.size(), Vec3f::Zero());
    shapes.reset();
    for_constraints([](Constraint& constraint) { constraint.reset(); });
    sleep.wake_all(particles);
}

}  // namespace eti::pbd
