// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/accuracy/lift_reference.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/model/pace.hpp"
#include "server/patient/model/tetrahedra_of.hpp"
#include "server/scene/friction.hpp"
#include "tests/bench/server/accuracy/block_cases.hpp"
#include "tests/validation/fem/smooth_grid.hpp"

namespace eti::bench {

namespace {

constexpr std::uint32_t none = ~0u;
constexpr double near_tongue = 2e-3;  // [m], from vertices at rest: distance from which the blade matters
// As in the scene's blade and shell.

constexpr double at_rest = 1e-4;         // bound for the relative change of the force in the last step
constexpr double deepest = 0.02e-3;      // [m], of a contact with the blade at the end
constexpr double shortest = 0.1;         // of the scene's steps, in time
constexpr int most_steps_at_rest = 200;  // with the blade at rest
// [s], for which drag is negligible: a ten-thousandth relative to the tongue's slowest motion, 36 ms.
constexpr double for_ever = 360.0;

}  // namespace

LiftReference::LiftReference(const Scenario& scenario, const patient::Patient& patient,
                             const Surroundings& surroundings, const LiftSettings& choice)
    : surroundings_(surroundings), choice_(choice) {
    make_problem(scenario, patient);
    fem::PathSettings settings;
    settings.stiffness = choice.stiffness;
    settings.sticking = choice.sticking;
    settings.solid_spring = choice.shell;
    path_ = std::make_unique<fem::FrictionPath>(problem_, settings);
    const std::vector<std::size_t> at = stops();
    for (std::size_t k = 0; k < at.size(); ++k) {
        go(static_cast<double>(k == 0 ? 0 : at[k - 1]), static_cast<double>(at[k]));
    }
    come_to_rest();
    const Eigen::VectorXd& x = path_->position();
    scene::SoftTissue tissue = surroundings_.tissue.front();
    std::vector<Vec3f>& position = tissue.body().particles.position;
    const std::vector<Vec3d> force = path_->tool_force();
    lift.force = force_on_blade();
    lift.touched.resize(position.size(), false);
    for (std::size_t n = 0; n < particle_.size(); ++n) {
        const std::uint32_t i = particle_[n];
        if (surroundings_.free[i]) {
            position[i] = x.segment<3>(3 * static_cast<Eigen::Index>(n)).cast<float>();
            lift.touched[i] = !force[n].isZero(0.0);
        }
    }
    for (const Vec3f& p : position) {
        lift.position.push_back(p.cast<double>());
    }
    scene::Snapshot snapshot = surroundings_.snapshot;
    tissue.frames(snapshot.frames);
    lift.opening = opening_of(patient, surroundings_.scope, snapshot);
}

Vec3d LiftReference::force_on_blade() const {
    const std::vector<Vec3d> force = path_->tool_force();
    Vec3d sum = Vec3d::Zero();
    for (std::size_t n = 0; n < particle_.size(); ++n) {
        if (surroundings_.free[particle_[n]]) {
            sum -= force[n];
        }
    }
    return sum;
}

Eigen::Isometry3d LiftReference::blade_at(double step) const {
    const auto before = static_cast<std::size_t>(step);
    const std::size_t after = std::min(before + 1, surroundings_.blade.size() - 1);
    const double share = step - static_cast<double>(before);
    const RigidTransform& a = surroundings_.blade[before];
    const RigidTransform& b = surroundings_.blade[after];
    return Eigen::Translation3d((1.0 - share) * a.translation.cast<double>() +
                                share * b.translation.cast<double>()) *
           a.rotation.cast<double>().normalized().slerp(share, b.rotation.cast<double>().normalized());
}

std::vector<double> LiftReference::held_at(double step) const {
    const auto before = static_cast<std::size_t>(step);
    const std::size_t after = std::min(before + 1, surroundings_.blade.size() - 1);
    const double share = step - static_cast<double>(before);
    std::vector<double> displacement;
    for (std::size_t n = 0; n < surroundings_.held.size(); ++n) {
        const Vec3d place = (1.0 - share) * surroundings_.held_at[before][n].cast<double>() +
                            share * surroundings_.held_at[after][n].cast<double>();
        const Vec3d way = place - surroundings_.rest[surroundings_.held[n]].cast<double>();
        displacement.insert(displacement.end(), way.data(), way.data() + 3);
    }
    return displacement;
}

void LiftReference::go(double from, double to) {
    const fem::Increment done =
        path_->step(blade_at(to), held_at(to), (to - from) * step_duration, choice_.on_the_way);
    iterations += done.iterations;
    spdlog::debug("lift: to step {}: {} iterations, residual {:.1g}, {:.3f} mm deep, {:.3f} N", to,
                  done.iterations, done.residual, 1e3 * done.penetration, force_on_blade().norm());
    if (done.converged) {
        ++increments;
        return;
    }
    if (to - from < shortest) {
        throw std::runtime_error(
            fmt::format("the reference of the lifted tongue did not converge at step {:g}", to));
    }
    const double midway = 0.5 * (from + to);
    go(from, midway);
    go(midway, to);
}

void LiftReference::come_to_rest() {
    const auto last = static_cast<double>(surroundings_.blade.size() - 1);
    double duration = step_duration;
    for (int k = 0; k < most_steps_at_rest; ++k) {
        const Vec3d before = force_on_blade();
        const fem::Increment done = path_->step(blade_at(last), held_at(last), duration, choice_.at_rest);
        iterations += done.iterations;
        still = (force_on_blade() - before).norm() / force_on_blade().norm();
        spdlog::debug("lift: at rest, {:.3g} s: {} iterations, {}, {:.3f} mm deep, friction {:.1g}, {:.4f} N",
                      duration, done.iterations, done.converged, 1e3 * done.penetration, done.changed,
                      force_on_blade().norm());
        if (!done.converged) {
            duration *= 0.25;
            continue;
        }
        penetration = done.penetration;
        if (duration >= for_ever && still < at_rest && penetration < deepest) {
            return;
        }
        duration = std::min(2.0 * duration, for_ever);
    }
    throw std::runtime_error("the reference of the lifted tongue did not come to rest");
}

void LiftReference::make_problem(const Scenario& scenario, const patient::Patient& patient) {
    number_.assign(surroundings_.rest.size(), none);
    const auto vertex_of = [&](std::uint32_t i) {
        if (number_[i] == none) {
            number_[i] = static_cast<std::uint32_t>(particle_.size());
            particle_.push_back(i);
            problem_.body.rest.push_back(surroundings_.rest[i].cast<double>());
            problem_.radius.push_back(static_cast<double>(patient.particles.radius[i]));
            problem_.drag.push_back(choice_.drag * static_cast<double>(patient::tissue_damping) *
                                    static_cast<double>(patient.particles.mass[i]));
        }
        return number_[i];
    };
    for (const std::uint32_t t : patient::tetrahedra_of(Tissue::tongue, patient)) {
        auto& ends = problem_.body.tetrahedra.emplace_back();
        std::ranges::transform(patient.tetrahedra.corners[t], ends.begin(), vertex_of);
    }
    for (std::size_t l = 0; l < patient.links.ends.size(); ++l) {
        const auto& [a, b] = patient.links.ends[l];
        if (surroundings_.free[a] || surroundings_.free[b]) {
            problem_.springs.push_back(
                {vertex_of(a), vertex_of(b),
                 static_cast<double>((surroundings_.rest[a] - surroundings_.rest[b]).norm()),
                 static_cast<double>(patient.links.stiffness[l])});
        }
    }
    for (const std::uint32_t i : surroundings_.held) {
        problem_.body.hold(vertex_of(i));
    }
    problem_.body.youngs_modulus = static_cast<double>(scenario.runtime_parameters.tissue_stiffness);
    problem_.body.poisson_ratio = poisson_ratio;
    for (std::uint32_t n = 0; n < particle_.size(); ++n) {
        if (surroundings_.free[particle_[n]]) {
            problem_.points.push_back(n);
        }
    }
    for (const auto& [a, b] : surroundings_.edges) {
        if (number_[a] != none && number_[b] != none) {
            problem_.edges.push_back({number_[a], number_[b]});
        }
    }
    for (const std::uint32_t i : surroundings_.meets_shell) {
        problem_.on_solid.push_back(number_[i]);
    }
    for (const Capsule& c : surroundings_.scope.capsules) {
        problem_.tool.push_back({c.a.cast<double>(), c.b.cast<double>(), static_cast<double>(c.radius)});
    }
    shell_ = std::make_unique<fem::SmoothGrid>(surroundings_.shell);
    problem_.solid = shell_.get();
    problem_.tool_friction = static_cast<double>(scene::mucosa_on_steel.kinetic_coefficient);
    problem_.solid_friction = static_cast<double>(scene::mucosa_on_mucosa.kinetic_coefficient);
}

std::vector<std::size_t> LiftReference::stops() const {
    const auto ends_at = [&](std::size_t step) {
        std::vector<Vec3f> ends;
        for (const Capsule& c : surroundings_.scope.capsules) {
            ends.push_back(surroundings_.blade[step] * c.a);
            ends.push_back(surroundings_.blade[step] * c.b);
        }
        return ends;
    };
    constexpr std::size_t of_handle = 2;  // the handle stays outside
    const auto reaches = [&](std::size_t step) {
        const std::vector<Vec3f> ends = ends_at(step);
        return std::ranges::any_of(particle_, [&](std::uint32_t i) {
            for (std::size_t c = 0; c < surroundings_.scope.capsules.size(); ++c) {
                const Vec3f to = offset_from_segment(ends[2 * c], ends[2 * c + 1], surroundings_.rest[i]);
                if (static_cast<double>(to.norm() - surroundings_.scope.capsules[c].radius) < near_tongue) {
                    return true;
                }
            }
            return false;
        });
    };
    std::vector<std::size_t> out;
    std::size_t step = 0;
    while (step + 2 < surroundings_.blade.size() && !reaches(step)) {
        ++step;
    }
    out.push_back(step);
    for (; step < surroundings_.blade.size(); ++step) {
        double way = 0.0;
        const std::vector<Vec3f> now = ends_at(step);
        const std::vector<Vec3f> last = ends_at(out.back());
        for (std::size_t k = of_handle; k < now.size(); ++k) {
            way = std::max(way, static_cast<double>((now[k] - last[k]).norm()));
        }
        if (way >= choice_.increment || step >= out.back() + choice_.longest ||
            step + 1 == surroundings_.blade.size()) {
            out.push_back(step);
        }
    }
    return out;
}

double LiftReference::apart(const LiftState& other) const {
    double apart = 0.0;
    double moved = 0.0;
    for (std::size_t i = 0; i < surroundings_.free.size(); ++i) {
        if (surroundings_.free[i]) {
            apart += (other.position[i] - lift.position[i]).squaredNorm();
            moved += (lift.position[i] - surroundings_.rest[i].cast<double>()).squaredNorm();
        }
    }
    return std::sqrt(apart / moved);
}

Vec3d LiftReference::material(const LiftState& other) const {
    Eigen::VectorXd x(3 * static_cast<Eigen::Index>(particle_.size()));
    for (std::size_t n = 0; n < particle_.size(); ++n) {
        x.segment<3>(3 * static_cast<Eigen::Index>(n)) = other.position[particle_[n]];
    }
    const Eigen::VectorXd held_by = path_->internal_force(x);
    Vec3d sum = Vec3d::Zero();
    for (std::size_t n = 0; n < particle_.size(); ++n) {
        if (surroundings_.free[particle_[n]] && other.touched[particle_[n]]) {
            sum -= held_by.segment<3>(3 * static_cast<Eigen::Index>(n));
        }
    }
    return sum;
}

}  // namespace eti::bench
