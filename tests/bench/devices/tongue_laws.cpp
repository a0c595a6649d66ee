// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/devices/tongue_laws.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/model/pace.hpp"
#include "devices/haptics/soft_force.hpp"
#include "server/app/run/simulation.hpp"
#include "server/patient/model/skeleton.hpp"
#include "server/pbd/implicit/implicit_mesh.hpp"
#include "server/scene/scene.hpp"
#include "tests/validation/fem/static_solver.hpp"

namespace eti::bench {

namespace {

constexpr double poisson_ratio = 0.45;
constexpr int iterations = 8;                // conjugate gradients of a step
constexpr int steps = 2 * steps_per_second;  // the blade goes down in the first half of them
constexpr int averaged = steps / 10;         // at the end, over which its force is averaged
constexpr float damping = 40.0f;             // [1/s]
constexpr double penalty = 2000.0;  // [N/m] per node of the finite elements: some 0.02 mm under the blade

/// The patient's tongue at the scenario's posture, held where it is fixed to bone or to the floor of the
/// mouth. The blade's distal capsule, oriented as in the lift, is pressed into the tongue's back.
struct Tongue {
    std::vector<Vec3f> rest;  // [m]
    std::vector<float> volume;
    std::vector<bool> held;
    std::vector<std::array<std::uint32_t, 4>> tetrahedra;
    Vec3d down, touching;         // the blade's direction, and the point of its axis at first contact
    Vec3d along = Vec3d::Zero();  // its axis
    double radius = 0.0;          // [m]

    [[nodiscard]] Vec3d axis_at(double depth) const { return touching + depth * down; }
};

Tongue tongue_of(const Scenario& scenario) {
    const patient::Patient patient = app::patient_of(scenario);
    const patient::BonePoses bones = patient::pose_bones(
        patient.skeleton,
        {scenario.runtime_parameters.head_elevation, scenario.runtime_parameters.jaw_opening});
    const patient::ParticleSet& set = patient.particles;
    Tongue tongue;
    std::vector<std::uint32_t> number(set.size(), ~0u);
    for (std::uint32_t i = 0; i < set.size(); ++i) {
        if (set.tissue[i] == Tissue::tongue) {
            number[i] = static_cast<std::uint32_t>(tongue.rest.size());
            tongue.rest.push_back(patient::pose_point(set.rest[i], set.bones[i], bones));
            tongue.volume.push_back(8.0f * set.radius[i] * set.radius[i] * set.radius[i]);
            tongue.held.push_back(set.mass[i] == 0.0f);
        }
    }
    for (const auto& ends : patient.links.ends) {
        for (const std::uint32_t i : ends) {
            if (number[i] != ~0u) {
                tongue.held[number[i]] = true;
            }
        }
    }
    std::vector<bool> meshed(tongue.rest.size(), false);
    for (auto corners : patient.tetrahedra.corners) {
        if (set.tissue[corners[0]] == Tissue::tongue) {
            for (std::uint32_t& i : corners) {
                i = number[i];
                meshed[i] = true;
            }
            tongue.tetrahedra.push_back(corners);
        }
    }
    for (std::size_t i = 0; i < meshed.size(); ++i) {  // a few are isolated
        tongue.held[i] = tongue.held[i] || !meshed[i];
    }
    // The axis of the expert's blade in the lift.
    tongue.along = Vec3d(0.0, 0.8, -0.6);
    tongue.down = Vec3d(0.0, -0.6, -0.8);
    tongue.radius = static_cast<double>(make_laryngoscope(scenario.blade).capsules[2].radius);
    double highest = -1.0;
    for (std::size_t i = 0; i < tongue.rest.size(); ++i) {
        const Vec3d p = tongue.rest[i].cast<double>();
        if (!tongue.held[i] && std::fabs(p.x()) < 1e-3 && -p.dot(tongue.down) > highest) {
            highest = -p.dot(tongue.down);
            tongue.touching = Vec3d(0.0, p.y(), p.z()) - tongue.radius * tongue.down;
        }
    }
    return tongue;
}

/// Positions [m], and the force on the blade along its path [N].
struct Pressed {
    std::vector<Vec3d> position;
    double force = 0.0;
    std::vector<Vec3f> contact_force;  ///< [N], of each particle on the blade, mean over the end
};

Pressed press_by_finite_elements(const Tongue& tongue, double depth, double youngs_modulus) {
    fem::Problem problem;
    for (const Vec3f& p : tongue.rest) {
        problem.rest.push_back(p.cast<double>());
    }
    problem.tetrahedra = tongue.tetrahedra;
    problem.youngs_modulus = youngs_modulus;
    problem.poisson_ratio = poisson_ratio;
    for (std::uint32_t i = 0; i < tongue.rest.size(); ++i) {
        if (tongue.held[i]) {
            problem.hold(i);
        }
    }
    Pressed out;
    constexpr int stages = 4;
    for (int k = 1; k <= stages; ++k) {
        const Vec3d centre = tongue.axis_at(depth * k / stages);
        problem.obstacles = {
            {centre - 0.03 * tongue.along, centre + 0.03 * tongue.along, tongue.radius, penalty}};
        const fem::Solution solution = fem::solve(problem, out.position);
        if (!solution.converged) {
            throw std::runtime_error(
                fmt::format("the reference of the tongue did not converge at stage {}", k));
        }
        out.position = solution.position;
    }
    Eigen::VectorXd x(3 * static_cast<Eigen::Index>(out.position.size()));
    for (std::size_t i = 0; i < out.position.size(); ++i) {
        x.segment<3>(3 * static_cast<Eigen::Index>(i)) = out.position[i];
    }
    out.force = -fem::Potential(problem).force_on_obstacles(x).dot(tongue.down);
    return out;
}

/// The tongue's particles at rest.
pbd::Particles particles_of(const Tongue& tongue) {
    pbd::Particles p;
    p.resize(tongue.rest.size());
    p.rest = p.position = p.predicted = tongue.rest;
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.inverse_mass[i] = tongue.held[i] ? 0.0f : 1.0f / (patient::tissue_density * tongue.volume[i]);
    }
    return p;
}

pbd::Tetrahedra::Description mesh_of(const Tongue& tongue, double youngs_modulus) {
    pbd::Tetrahedra::Description mesh;
    mesh.tetrahedra = tongue.tetrahedra;
    mesh.youngs_modulus.assign(mesh.tetrahedra.size(), static_cast<float>(youngs_modulus));
    mesh.poisson_ratio = static_cast<float>(poisson_ratio);
    return mesh;
}

/// The blade's axis after a share of the time, with its final depth.
Capsule blade_at(const Tongue& tongue, double depth, double share) {
    const Vec3d centre = tongue.axis_at(depth * std::min(1.0, 2.0 * share));
    return {Vec3d(centre - 0.03 * tongue.along).cast<float>(),
            Vec3d(centre + 0.03 * tongue.along).cast<float>(), static_cast<float>(tongue.radius)};
}

/// One solve per step, with the blade's contacts included.
Pressed by_implicit_mesh(const Tongue& tongue, double depth, double youngs_modulus) {
    pbd::Particles p = particles_of(tongue);
    pbd::ImplicitMesh mesh;
    mesh.configure({mesh_of(tongue, youngs_modulus), {}}, p, p.inverse_mass);
    mesh.settings.iterations = iterations;
    std::vector<bool> meshed(p.size(), false);
    for (const std::uint32_t i : mesh.particles()) {
        meshed[i] = !tongue.held[i];
    }
    constexpr float dt = step_duration;
    const float keep = std::exp(-damping * dt) / dt;
    std::vector<Vec3f> force(p.size(), Vec3f::Zero());
    Pressed out;
    out.contact_force.assign(p.size(), Vec3f::Zero());
    for (int step = 0; step < steps; ++step) {
        const Capsule blade = blade_at(tongue, depth, static_cast<double>(step + 1) / steps);
        mesh.contacts.clear();
        for (std::uint32_t i = 0; i < p.size(); ++i) {
            p.predicted[i] = p.position[i];
            if (!meshed[i]) {
                continue;
            }
            const Vec3f away = offset_from_segment(blade.a, blade.b, p.position[i]);
            const float distance = away.norm();
            if (distance < blade.radius || !force[i].isZero(0.0f)) {
                pbd::MeshContact& c = mesh.contacts.emplace_back();
                c.particle = {i};
                c.normal = away / distance;
                c.gap = distance - blade.radius;
                c.force = force[i];
            }
        }
        mesh.solve(p, dt);
        std::ranges::fill(force, Vec3f::Zero());
        for (const pbd::MeshContact& c : mesh.contacts) {
            force[c.particle[0]] = c.force;
            if (step >= steps - averaged) {
                out.contact_force[c.particle[0]] -= c.force / static_cast<float>(averaged);
            }
        }
        for (std::size_t i = 0; i < p.size(); ++i) {
            p.velocity[i] = keep * (p.predicted[i] - p.position[i]);
            p.position[i] = p.predicted[i];
        }
    }
    for (const Vec3f& x : p.position) {
        out.position.push_back(x.cast<double>());
    }
    return out;
}

}  // namespace

std::vector<LawForce> tongue_laws(bool quick) {
    const Scenario scenario = load_scenario(find_data_file("term", "scenarios"));
    const auto modulus = static_cast<double>(scenario.runtime_parameters.tissue_stiffness);
    const Tongue tongue = tongue_of(scenario);
    std::vector<LawForce> out;
    for (const double depth : quick ? std::vector{4e-3} : std::vector{1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3}) {
        const double reference = press_by_finite_elements(tongue, depth, modulus).force;
        const Pressed pressed = by_implicit_mesh(tongue, depth, modulus);
        const Capsule blade = blade_at(tongue, depth, 1.0);
        std::vector<devices::TissuePoint> points;
        Vec3f sum = Vec3f::Zero();
        for (std::size_t i = 0; i < pressed.position.size(); ++i) {
            sum += pressed.contact_force[i];
            if (pressed.contact_force[i].norm() > 0.0f) {
                // Particles touch the blade by their centres here, like those of the scene's surface.
                points.push_back({pressed.position[i].cast<float>(), tongue.rest[i], 0.1e-3f, Tissue::tongue,
                                  pressed.contact_force[i]});
            }
        }
        const Wrench displaced =
            devices::displacement_wrench(points, std::span(&blade, 1), {}, devices::tissue_stiffness());
        const Vec3f back = -tongue.down.cast<float>();
        out.push_back({"constraint", depth, static_cast<double>(sum.dot(back)), reference});
        out.push_back({"displacement", depth, static_cast<double>(displaced.force.dot(back)), reference});
    }
    return out;
}

}  // namespace eti::bench
