// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "common/model/pace.hpp"
#include "devices/haptics/soft_force.hpp"
#include "server/app/run/simulation.hpp"
#include "server/patient/model/skeleton.hpp"
#include "server/pbd/contact/contact.hpp"
#include "server/pbd/soft/cluster_calibration.hpp"
#include "server/pbd/soft/implicit_mesh.hpp"
#include "server/pbd/soft/soft_body.hpp"
#include "server/scene/scene.hpp"
#include "tests/bench/server/accuracy/accuracy_table.hpp"
#include "tests/bench/server/accuracy/block_cases.hpp"
#include "tests/bench/server/accuracy/tongue_laws.hpp"

namespace eti::bench {

namespace {

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
    std::vector<std::vector<std::uint32_t>> clusters;
    float spacing = 0.0f;         // [m]
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
            tongue.spacing = 2.0f * set.radius[i];
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
    for (std::size_t c = 0; c < patient.clusters.size(); ++c) {
        if (patient.clusters.tissue[c] != Tissue::tongue) {
            continue;
        }
        std::vector<std::uint32_t> members;
        for (const std::uint32_t i : patient.clusters.members(c)) {
            members.push_back(number[i]);
        }
        tongue.clusters.push_back(std::move(members));
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
    double frame_ms = 0.0;
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
Pressed by_implicit_mesh(const Tongue& tongue, double depth, int iterations, double youngs_modulus) {
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
    const auto start = std::chrono::steady_clock::now();
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
                out.force += c.force.cast<double>().dot(tongue.down) / averaged;
            }
        }
        for (std::size_t i = 0; i < p.size(); ++i) {
            p.velocity[i] = keep * (p.predicted[i] - p.position[i]);
            p.position[i] = p.predicted[i];
        }
    }
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start;
    out.frame_ms = wall.count() / steps * steps_per_second / 90.0;
    for (const Vec3f& x : p.position) {
        out.position.push_back(x.cast<double>());
    }
    return out;
}

Pressed press_by_particles(const Tongue& tongue, double depth, Method method, int substeps,
                           double youngs_modulus) {
    pbd::SoftBody body;
    body.settings.damping = damping;
    pbd::Particles& p = body.particles;
    p = particles_of(tongue);
    pbd::ShapeMatching::Description clusters;
    clusters.first.push_back(0);
    for (const float volume : tongue.volume) {
        clusters.particle_volume.push_back(volume);
        clusters.fitting_mass.push_back(patient::tissue_density * volume);
    }
    const float dt = step_duration / static_cast<float>(substeps);
    const auto wanted = static_cast<float>(youngs_modulus);
    pbd::Tetrahedra::Description mesh;
    if (method == Method::tetrahedra) {
        mesh = mesh_of(tongue, youngs_modulus);
    } else {
        const std::optional<pbd::ClusterLoad> load = calibration_of(method);
        const float modulus = load ? pbd::calibrated_modulus({.spacing = tongue.spacing,
                                                              .density = patient::tissue_density,
                                                              .substep = dt,
                                                              .load = *load},
                                                             wanted)
                                         .input_modulus
                                   : wanted;
        for (const auto& members : tongue.clusters) {
            clusters.member.insert(clusters.member.end(), members.begin(), members.end());
            clusters.first.push_back(static_cast<std::uint32_t>(clusters.member.size()));
            clusters.youngs_modulus.push_back(modulus);
        }
    }
    body.shapes.configure(clusters, p);
    XpbdTetrahedra tetrahedra;
    tetrahedra.configure(mesh, p);
    body.links.configure({}, {}, p);

    Pressed out;
    out.contact_force.assign(p.size(), Vec3f::Zero());
    const auto start = std::chrono::steady_clock::now();
    for (int step = 0; step < steps; ++step) {
        for (int s = 0; s < substeps; ++s) {
            const Capsule blade =
                blade_at(tongue, depth, (step + static_cast<double>(s + 1) / substeps) / steps);
            const pbd::MovingCapsule capsule{blade.a, blade.b, blade.a, blade.b, blade.radius};
            body.predict(dt, 1.0f);
            body.project(dt);
            tetrahedra.project(p, dt);
            for (std::size_t i = 0; i < p.size(); ++i) {
                if (p.inverse_mass[i] == 0.0f) {
                    continue;
                }
                const Vec3f push = pbd::push_out_of(capsule, p.position[i], p.predicted[i], 0.0f, 0.0f);
                p.predicted[i] += push;
                if (step >= steps - averaged) {
                    out.contact_force[i] -=
                        push / (p.inverse_mass[i] * dt * dt * static_cast<float>(averaged * substeps));
                    out.force += push.cast<double>().dot(tongue.down) /
                                 static_cast<double>(p.inverse_mass[i] * dt * dt) / (averaged * substeps);
                }
            }
            body.finish(dt);
        }
    }
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start;
    out.frame_ms = wall.count() / steps * steps_per_second / 90.0;
    for (const Vec3f& x : p.position) {
        out.position.push_back(x.cast<double>());
    }
    return out;
}

/// RMS difference relative to the RMS displacement.
double difference(const Tongue& tongue, const Pressed& found, const Pressed& expected) {
    double apart = 0.0;
    double moved = 0.0;
    for (std::size_t i = 0; i < tongue.rest.size(); ++i) {
        apart += (found.position[i] - expected.position[i]).squaredNorm();
        moved += (expected.position[i] - tongue.rest[i].cast<double>()).squaredNorm();
    }
    return std::sqrt(apart / moved);
}

}  // namespace

std::vector<LawForce> tongue_laws(bool quick) {
    const Scenario scenario = load_scenario(find_data_file("term", "scenarios"));
    const auto modulus = static_cast<double>(scenario.runtime_parameters.tissue_stiffness);
    const Tongue tongue = tongue_of(scenario);
    std::vector<LawForce> out;
    for (const double depth : quick ? std::vector{4e-3} : std::vector{1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3}) {
        const double reference = press_by_finite_elements(tongue, depth, modulus).force;
        const Pressed pressed =
            press_by_particles(tongue, depth, Method::tetrahedra, scenario.physics.substeps, modulus);
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

void press_tongue(AccuracyTable& table, Table& forces, bool quick) {
    Scenario scenario = load_scenario(find_data_file("term", "scenarios"));
    const auto modulus = static_cast<double>(scenario.runtime_parameters.tissue_stiffness);
    const std::vector<double> depths = quick ? std::vector{4e-3} : std::vector{2e-3, 4e-3, 6e-3};
    for (const double spacing : quick ? std::vector{2.5e-3} : std::vector{2.5e-3, 2.0e-3}) {
        scenario.physics.spacing = static_cast<float>(spacing);
        const Tongue tongue = tongue_of(scenario);
        std::vector<Pressed> expected;
        for (const double depth : depths) {
            expected.push_back(press_by_finite_elements(tongue, depth, modulus));
        }
        struct Row {
            Method method;
            int substeps, iterations;
        };
        std::vector<Row> rows;
        for (const Method method : {Method::shape_matching_xpbd, Method::clusters_for_indentation,
                                    Method::clusters_for_tongue, Method::tetrahedra}) {
            for (const int substeps : quick ? std::vector{8} : std::vector{4, 8, 16}) {
                rows.push_back({method, substeps, 1});
            }
        }
        for (const int iterations : quick ? std::vector{8} : std::vector{5, 8, 10}) {
            rows.push_back({Method::tetrahedra_implicit, 1, iterations});
        }
        for (const auto& [method, substeps, iterations] : rows) {
            if (!table.shard().claim_next()) {
                continue;
            }
            const std::string_view name = name_of(method);
            double force = 0.0;
            double shape = 0.0;
            double frame_ms = 0.0;
            for (std::size_t k = 0; k < depths.size(); ++k) {
                const Pressed found = method == Method::tetrahedra_implicit
                                          ? by_implicit_mesh(tongue, depths[k], iterations, modulus)
                                          : press_by_particles(tongue, depths[k], method, substeps, modulus);
                force += std::pow(found.force / expected[k].force - 1.0, 2);
                shape += std::pow(difference(tongue, found, expected[k]), 2);
                frame_ms += found.frame_ms;
                forces.row(fmt::format("tongue,\"{}\",{:g},{},{},{:g},{:.6g},{:.6g}", name, 1e3 * spacing,
                                       substeps, iterations, 1e3 * depths[k], found.force,
                                       expected[k].force));
            }
            const auto n = static_cast<double>(depths.size());
            const std::size_t particles = tongue.rest.size();
            table.add({"tongue-force", name, spacing, substeps, iterations, particles, std::sqrt(force / n),
                       frame_ms / n});
            table.add({"tongue-shape", name, spacing, substeps, iterations, particles, std::sqrt(shape / n),
                       frame_ms / n});
        }
    }
}

}  // namespace eti::bench
