// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/links.hpp"

#include <cassert>

namespace eti::pbd {

namespace {

/// `compliance` [1/kg]: over dt^2.
void project_compliant(Vec3f& a, Vec3f& b, float inverse_mass_a, float inverse_mass_b, float length,
                       float compliance) {
    const Vec3f apart = b - a;
    const float distance = apart.norm();
    const float inverse_mass = inverse_mass_a + inverse_mass_b;
    if (distance < 1e-9f || inverse_mass == 0.0f) {
        return;
    }
    const Vec3f correction = apart * ((distance - length) / (distance * (inverse_mass + compliance)));
    a += inverse_mass_a * correction;
    b -= inverse_mass_b * correction;
}

float compliance_of(float stiffness, float dt) {
    return 1.0f / (stiffness * dt * dt);
}

}  // namespace

void project_link(Vec3f& a, Vec3f& b, float inverse_mass_a, float inverse_mass_b, float length,
                  float stiffness, float dt) {
    project_compliant(a, b, inverse_mass_a, inverse_mass_b, length, compliance_of(stiffness, dt));
}

void Links::configure(std::vector<std::array<std::uint32_t, 2>> ends, std::vector<float> stiffness,
                      const Particles& particles) {
    ends_ = std::move(ends);
    stiffness_ = std::move(stiffness);
    compliance_.reserve(ends_.size());
    compliance_dt_ = 0.0f;
    set_rest(particles);
}

void Links::set_rest(const Particles& particles) {
    length_.resize(ends_.size());
    for (std::size_t i = 0; i < ends_.size(); ++i) {
        length_[i] = (particles.rest[ends_[i][0]] - particles.rest[ends_[i][1]]).norm();
    }
}

void Links::set_stiffness(std::span<const float> stiffness) {
    assert(stiffness.size() == ends_.size());
    stiffness_.assign(stiffness.begin(), stiffness.end());
    compliance_dt_ = 0.0f;  // the next pass works out the compliances
}

void Links::project(Particles& particles, float dt) {
    if (dt != compliance_dt_) {
        compliance_.resize(ends_.size());
        for (std::size_t i = 0; i < ends_.size(); ++i) {
            compliance_[i] = compliance_of(stiffness_[i], dt);
        }
        compliance_dt_ = dt;
    }
    for (std::size_t i = 0; i < ends_.size(); ++i) {
        const auto [a, b] = ends_[i];
        project_compliant(particles.predicted[a], particles.predicted[b], particles.inverse_mass[a],
                          particles.inverse_mass[b], length_[i], compliance_[i]);
    }
}

}  // namespace eti::pbd
