// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/soft_body.hpp"

#include <cmath>

namespace eti::pbd {

void SoftBody::predict(float dt, float fraction) {
    Particles& p = particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.predicted[i] = p.inverse_mass[i] > 0.0f
                             ? Vec3f(p.position[i] + dt * p.velocity[i])
                             : Vec3f(p.position[i] + fraction * (p.rest[i] - p.position[i]));
    }
}

void SoftBody::project(float dt) {
    shapes.project(particles, dt);
    links.project(particles, dt);
}

void SoftBody::finish(float dt) {
    Particles& p = particles;
    const float keep = std::exp(-settings.damping * dt) / dt;
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.velocity[i] = keep * (p.predicted[i] - p.position[i]);
        p.position[i] = p.predicted[i];
    }
}

void SoftBody::set_rest() {
    shapes.set_rest(particles);
    links.set_rest(particles);
}

void SoftBody::reset() {
    particles.position = particles.rest;
    particles.predicted = particles.rest;
    particles.velocity.assign(particles.size(), Vec3f::Zero());
    shapes.reset();
}

}  // namespace eti::pbd
