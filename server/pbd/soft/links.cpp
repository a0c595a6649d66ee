// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/soft/links.hpp"

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

// Consecutive links mostly share a particle, so that the processor would wait for one link before it starts
// the next. The order therefore interleaves this many parts of the list.
constexpr std::size_t parts = 4;

std::vector<std::uint32_t> along_parts(std::size_t links) {
    const std::size_t length = (links + parts - 1) / parts;
    std::vector<std::uint32_t> order;
    for (std::size_t i = 0; i < length; ++i) {
        for (std::size_t link = i; link < links; link += length) {
            order.push_back(static_cast<std::uint32_t>(link));
        }
    }
    return order;
}

}  // namespace

void project_link(Vec3f& a, Vec3f& b, float inverse_mass_a, float inverse_mass_b, float length,
                  float stiffness, float dt) {
    project_compliant(a, b, inverse_mass_a, inverse_mass_b, length, compliance_of(stiffness, dt));
}

void Links::configure(std::vector<Pair> ends, std::vector<float> stiffness, const Particles& particles) {
    ends_ = std::move(ends);
    stiffness_ = std::move(stiffness);
    compliance_.reserve(ends_.size());
    met_.assign(ends_.size(), {Vec3f::Zero(), Vec3f::Zero()});
    order_ = along_parts(ends_.size());
    awake_ = order_;
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
    compliance_dt_ = 0.0f;  // the next pass computes the compliances
}

void Links::select(const Particles& particles) {
    awake_.clear();
    for (const std::uint32_t i : order_) {
        if (particles.asleep[ends_[i][0]] == 0 || particles.asleep[ends_[i][1]] == 0) {
            awake_.push_back(i);
        }
    }
}

void Links::project(Particles& particles, float dt) {
    if (dt != compliance_dt_) {
        compliance_.resize(ends_.size());
        for (std::size_t i = 0; i < ends_.size(); ++i) {
            compliance_[i] = compliance_of(stiffness_[i], dt);
        }
        compliance_dt_ = dt;
    }
    for (const std::uint32_t i : awake_) {
        const auto [a, b] = ends_[i];
        const bool a_moves = particles.asleep[a] == 0;
        const bool b_moves = particles.asleep[b] == 0;
        auto& [at_a, at_b] = met_[i];
        Vec3f to_a = a_moves ? particles.predicted[a] : at_a;
        Vec3f to_b = b_moves ? particles.predicted[b] : at_b;
        at_a = to_a;
        at_b = to_b;
        project_compliant(to_a, to_b, particles.inverse_mass[a], particles.inverse_mass[b], length_[i],
                          compliance_[i]);
        if (a_moves) {
            particles.predicted[a] = to_a;
        }
        if (b_moves) {
            particles.predicted[b] = to_b;
        }
    }
}

}  // namespace eti::pbd
