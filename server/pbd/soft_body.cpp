// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/soft_body.hpp"

#include <cmath>

#include "server/pbd/ranges.hpp"

namespace eti::pbd {

namespace {

constexpr std::size_t grain = 4096;  // particles worth handing to another thread

}  // namespace

void SoftBody::predict(float dt, float fraction) {
    Particles& p = particles;
    for_each(p.size(), grain, [&](std::size_t i) {
        p.predicted[i] = p.inverse_mass[i] > 0.0f
                             ? Vec3f(p.position[i] + dt * p.velocity[i])
                             : Vec3f(p.position[i] + fraction * (p.rest[i] - p.position[i]));
    });
}

void SoftBody::project(float dt) {
    shapes.project(particles, dt);
    tetrahedra.project(particles, dt);
    links.project(particles, dt);
}

void SoftBody::finish(float dt) {
    Particles& p = particles;
    const float keep = std::exp(-settings.damping * dt) / dt;
    for_each(p.size(), grain, [&](std::size_t i) {
        p.velocity[i] = keep * (p.predicted[i] - p.position[i]);
        p.position[i] = p.predicted[i];
    });
}

void SoftBody::set_rest() {
    shapes.set_rest(particles);
    tetrahedra.set_rest(particles);
    links.set_rest(particles);
}

void SoftBody::reset() {
    particles.position = particles.rest;
    particles.predicted = particles.rest;
    particles.velocity.assign(particles.size(), Vec3f::Zero());
    shapes.reset();
}

}  // namespace eti::pbd
