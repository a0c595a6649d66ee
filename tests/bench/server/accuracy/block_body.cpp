// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/accuracy/block_body.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "server/pbd/soft/cluster_calibration.hpp"

namespace eti::bench {

namespace {

constexpr double loading_time = 0.5;  // [s]
// The share of the distance to the goal that Mueller 2005 calls stiffness, chosen so that one pass at eight
// substeps and 2.5 mm is as stiff as the compliant method there; it depends on neither passes nor substeps.
constexpr double matched_step = 1.0 / 1440.0;
constexpr double matched_cell = 2.5e-3;

int cells(int length_mm, double cell) {
    return static_cast<int>(std::lround(length_mm * 1e-3 / cell));
}

std::vector<std::array<std::uint32_t, 8>> hexahedra_of(const test::TetrahedralLattice& lattice) {
    std::vector<std::array<std::uint32_t, 8>> hexahedra;
    for (int z = 0; z < lattice.nz; ++z) {
        for (int y = 0; y < lattice.ny; ++y) {
            for (int x = 0; x < lattice.nx; ++x) {
                std::array<std::uint32_t, 8>& corners = hexahedra.emplace_back();
                for (int v = 0; v < 8; ++v) {
                    corners[static_cast<std::size_t>(v)] = static_cast<std::uint32_t>(
                        lattice.index(x + (v & 1), y + (v >> 1 & 1), z + (v >> 2 & 1)));
                }
            }
        }
    }
    return hexahedra;
}

/// Of implicit methods an eighth of a cell to each corner, of others a quarter of a tetrahedron.
std::vector<double> shares_of_nodes(const test::TetrahedralLattice& lattice, Method method) {
    if (!is_implicit(method)) {
        return test::node_share(lattice, 1.0);
    }
    std::vector<double> share(lattice.position.size(), 0.0);
    for (const std::array<std::uint32_t, 8>& corners : hexahedra_of(lattice)) {
        for (const std::uint32_t i : corners) {
            share[i] += std::pow(lattice.cell, 3) / 8.0;
        }
    }
    return share;
}

double input_modulus_of(const BodySettings& setting, const test::TetrahedralLattice& lattice) {
    const std::optional<pbd::ClusterLoad> load = calibration_of(setting.method);
    if (!load) {
        return setting.youngs_modulus;
    }
    const int layers = std::min({lattice.nx, lattice.ny, lattice.nz});
    const pbd::ClusterBody body{.spacing = static_cast<float>(lattice.cell),
                                .density = static_cast<float>(particle_density),
                                .substep = static_cast<float>(setting.step / setting.substeps),
                                .thickness = static_cast<float>(layers * lattice.cell),
                                .load = *load};
    return static_cast<double>(
        pbd::calibrated_modulus(body, static_cast<float>(setting.youngs_modulus)).input_modulus);
}

}  // namespace

BlockBody::BlockBody(int x_mm, int y_mm, int z_mm, const BodySettings& setting)
    : setting_(setting),
      lattice_(test::tetrahedral_lattice(cells(x_mm, setting.cell), cells(y_mm, setting.cell),
                                         cells(z_mm, setting.cell), setting.cell)) {
    density_ = is_implicit(setting.method) ? implicit_density : particle_density;
    volume_ = shares_of_nodes(lattice_, setting.method);
    for (const double volume : volume_) {
        mass_.push_back(density_ * volume);
    }
    force.assign(mass_.size(), Vec3d::Zero());
    particles_.resize(mass_.size());
    for (std::size_t i = 0; i < mass_.size(); ++i) {
        particles_.rest[i] = lattice_.position[i].cast<float>();
        particles_.inverse_mass[i] = static_cast<float>(1.0 / mass_[i]);
    }
    particles_.position = particles_.predicted = particles_.rest;
}

void BlockBody::scale_mass(std::size_t i, double factor) {
    mass_[i] *= factor;
    particles_.inverse_mass[i] = static_cast<float>(1.0 / mass_[i]);
}

void BlockBody::hold(std::size_t i, const Vec3d& displacement) {
    const Vec3d rest = lattice_.position[i];
    hold_along(i, [rest, displacement](double share) { return Vec3d(rest + share * displacement); });
}

void BlockBody::hold_along(std::size_t i, std::function<Vec3d(double)> path) {
    particles_.inverse_mass[i] = 0.0f;
    held_.push_back({i, std::move(path)});
}

void BlockBody::substep(float dt, double share) {
    pbd::Particles& p = particles_;
    if (setting_.method == Method::mass_springs) {
        springs_.accelerate(p, dt);
    }
    const Vec3d acceleration = (share * 1000.0 / density_) * gravity;
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (p.inverse_mass[i] > 0.0f) {
            p.velocity[i] += dt * (acceleration + share * force[i] / mass_[i]).cast<float>();
            p.predicted[i] = p.position[i] + dt * p.velocity[i];
        }
    }
    for (const Held& h : held_) {
        p.predicted[h.particle] = h.path(share).cast<float>();
    }
    project(dt);
    if (contact && !is_implicit(setting_.method)) {
        contact(p, static_cast<double>(dt), share);
    }
    const float keep = static_cast<float>(std::exp(-setting_.damping * static_cast<double>(dt))) / dt;
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.velocity[i] = keep * (p.predicted[i] - p.position[i]);
        p.position[i] = p.predicted[i];
    }
}

void BlockBody::project(float dt) {
    pbd::Particles& p = particles_;
    if (is_implicit(setting_.method)) {
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (p.inverse_mass[i] > 0.0f) {
                p.predicted[i] = p.position[i];  // start of its only step
            }
        }
        if (before_solve) {
            before_solve(implicit_, p, static_cast<double>(dt));
        }
        implicit_.solve(p, dt);
        if (after_solve) {
            after_solve(implicit_, p, static_cast<double>(dt));
        }
        return;
    }
    for (int k = 0; k < setting_.iterations; ++k) {
        if (setting_.method != Method::mass_springs) {
            shapes_.project(p, dt);
        }
    }
}

void BlockBody::start() {
    if (is_implicit(setting_.method)) {
        const auto modulus = static_cast<float>(setting_.youngs_modulus);
        const auto ratio = static_cast<float>(setting_.poisson_ratio);
        pbd::ImplicitMesh::Description mesh;
        if (setting_.method == Method::tetrahedra_implicit) {
            mesh.tetrahedra = {lattice_.tetrahedra, std::vector<float>(lattice_.tetrahedra.size(), modulus),
                               ratio};
        } else {
            const std::vector<std::array<std::uint32_t, 8>> cells = hexahedra_of(lattice_);
            mesh.hexahedra = {cells, std::vector<float>(cells.size(), modulus), ratio};
        }
        implicit_.configure(mesh, particles_, particles_.inverse_mass);
        implicit_.settings.iterations = setting_.iterations;
    } else if (setting_.method == Method::mass_springs) {
        springs_ = test::MassSprings(lattice_, setting_.youngs_modulus);
    } else {
        pbd::ShapeMatching::Description description = test::lattice_clusters(
            lattice_, mass_, volume_, input_modulus_of(setting_, lattice_), setting_.cluster_radius);
        if (setting_.method == Method::shape_matching_pbd) {
            // k = 5 E V / (n r^2) per membership of mass m / n; V = cell^3, r^2 = 5/3 of 2 cell^2.
            const double stiffness_over_mass =
                5.0 * setting_.youngs_modulus /
                (particle_density * (10.0 / 3.0) * matched_cell * matched_cell);
            const double x = stiffness_over_mass * matched_step * matched_step;
            description.goal_share = static_cast<float>(x / (1.0 + x));
        }
        shapes_.configure(description, particles_);
    }
}

void BlockBody::step(double share_before, double share_after) {
    const int substeps = cut ? cut() : setting_.substeps;
    const auto dt = static_cast<float>(setting_.step / substeps);
    for (int s = 0; s < substeps; ++s) {
        substep(dt, share_before + (s + 1.0) / substeps * (share_after - share_before));
    }
}

bool BlockBody::is_finite() const {
    return particles_.velocity.back().allFinite();
}

int BlockBody::settle_below(double slow, int most) {
    int still = 0;
    int steps = 0;
    while (still < 10 && steps < most && is_finite()) {
        step();
        ++steps;
        float greatest = 0.0f;
        for (const Vec3f& v : particles_.velocity) {
            greatest = std::max(greatest, v.norm());
        }
        still = static_cast<double>(greatest) < slow ? still + 1 : 0;
    }
    return steps;
}

double BlockBody::settle(double seconds) {
    start();
    const int steps = static_cast<int>(std::lround(seconds / setting_.step));
    const auto share_at = [&](int step) { return std::min(1.0, step * setting_.step / loading_time); };
    const auto before = std::chrono::steady_clock::now();
    int taken = 0;
    for (; taken < steps && is_finite(); ++taken) {
        step(share_at(taken), share_at(taken + 1));
        if (watch) {
            watch(particles_);
        }
    }
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - before;
    return wall.count() / (taken * setting_.step * 90.0);
}

Vec3d BlockBody::displacement_at(const Vec3d& rest) const {
    const std::array<int, 3> count = {lattice_.nx, lattice_.ny, lattice_.nz};
    std::array<int, 3> low{};
    Vec3d share;
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const double at = rest[axis] / lattice_.cell;
        low[a] = std::clamp(static_cast<int>(std::floor(at)), 0, count[a] - 1);
        share[axis] = at - low[a];
    }
    Vec3d sum = Vec3d::Zero();
    for (int v = 0; v < 8; ++v) {
        double weight = 1.0;
        for (int axis = 0; axis < 3; ++axis) {
            weight *= (v >> axis & 1) != 0 ? share[axis] : 1.0 - share[axis];
        }
        const std::size_t i = lattice_.index(low[0] + (v & 1), low[1] + (v >> 1 & 1), low[2] + (v >> 2 & 1));
        sum += weight * (particles_.position[i].cast<double>() - lattice_.position[i]);
    }
    return sum;
}

}  // namespace eti::bench
