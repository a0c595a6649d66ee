// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/matter/block.hpp"

#include <algorithm>
#include <cmath>

#include "server/pbd/contact/surface_edges.hpp"
#include "tests/support/tetrahedral_lattice.hpp"

namespace eti::bench {

namespace {

constexpr double block_density = 1000.0;  // [kg/m^3]

}  // namespace

Block::Block(const BlockSettings& settings) : settings_(settings) {
    std::array<int, 3>& n = count_;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        n[axis] = static_cast<int>(std::lround(settings.size[axis] / settings.cell));
    }
    const test::TetrahedralLattice lattice = test::tetrahedral_lattice(n[0], n[1], n[2], settings.cell);
    rest_ = lattice.position;
    tetrahedra_ = lattice.tetrahedra;
    const double share = block_density * std::pow(settings.cell, 3) / 8.0;
    std::vector<double> mass(rest_.size(), 0.0);
    for (int k = 0; k < n[2]; ++k) {
        for (int j = 0; j < n[1]; ++j) {
            for (int i = 0; i < n[0]; ++i) {
                std::array<std::uint32_t, 8>& cell = cells_.emplace_back();
                for (int v = 0; v < 8; ++v) {
                    const std::uint32_t corner = index_of(i + (v & 1), j + (v >> 1 & 1), k + (v >> 2 & 1));
                    cell[static_cast<std::size_t>(v)] = corner;
                    mass[corner] += share;
                }
            }
        }
    }
    particles_.resize(rest_.size());
    for (std::size_t i = 0; i < rest_.size(); ++i) {
        particles_.rest[i] = particles_.position[i] = particles_.predicted[i] = rest_[i].cast<float>();
        particles_.inverse_mass[i] = static_cast<float>(1.0 / mass[i]);
    }
    scope_.capsules.fill({Vec3f::Constant(10.0f), Vec3f::Constant(10.0f), 0.0f});
    nothing_.size = {2, 2, 2};
    nothing_.value.assign(8, 1.0f);
}

void Block::hold(const std::function<bool(const Vec3d&)>& those) {
    for (std::size_t i = 0; i < rest_.size(); ++i) {
        if (those(rest_[i])) {
            particles_.inverse_mass[i] = 0.0f;
        }
    }
}

void Block::start() {
    pbd::ImplicitMesh::Description description;
    const auto modulus = static_cast<float>(settings_.youngs_modulus);
    const auto ratio = static_cast<float>(settings_.poisson_ratio);
    if (settings_.element == Element::tetrahedra) {
        description.tetrahedra = {tetrahedra_, std::vector<float>(tetrahedra_.size(), modulus), ratio};
    } else {
        description.hexahedra = {cells_, std::vector<float>(cells_.size(), modulus), ratio};
    }
    mesh_.settings.iterations = settings_.iterations;
    mesh_.configure(description, particles_, particles_.inverse_mass);
    std::vector<std::uint32_t> movers;
    for (std::uint32_t i = 0; i < rest_.size(); ++i) {
        if (particles_.inverse_mass[i] > 0.0f) {
            movers.push_back(i);
        }
    }
    const auto moves = [&](std::uint32_t i) { return particles_.inverse_mass[i] > 0.0f; };
    std::vector<scene::TongueContacts::Triangle> triangles = pbd::surface_triangles(tetrahedra_);
    std::erase_if(triangles, [&](const auto& t) { return std::ranges::none_of(t, moves); });
    contacts_.configure(movers, {.particles = {}, .triangles = std::move(triangles)});
}

void Block::place_capsule(const Vec3d& a, const Vec3d& b, double radius) {
    scope_.capsules.back() = {a.cast<float>(), b.cast<float>(), static_cast<float>(radius)};
    pressed_ = true;
}

void Block::step() {
    pbd::Particles& p = particles_;
    const auto dt = static_cast<float>(settings_.dt);
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (p.inverse_mass[i] > 0.0f) {
            p.velocity[i] += dt * gravity.cast<float>();
            p.predicted[i] = p.position[i];
        }
    }
    if (pressed_) {
        contacts_.find(p, {scope_, {}, {}}, {nothing_, 1}, mesh_.contacts);
        for (pbd::MeshContact& c : mesh_.contacts) {
            c.friction = 0.0f;
        }
    }
    mesh_.solve(p, dt);
    const float keep = std::exp(-static_cast<float>(settings_.damping) * dt) / dt;
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.velocity[i] = keep * (p.predicted[i] - p.position[i]);
        p.position[i] = p.predicted[i];
    }
}

double Block::speed() const {
    float most = 0.0f;
    for (const Vec3f& v : particles_.velocity) {
        most = std::max(most, v.norm());
    }
    return static_cast<double>(most);
}

int Block::settle(double slow, int most) {
    int still = 0;
    int steps = 0;
    while (still < 10 && steps < most) {
        step();
        ++steps;
        still = speed() < slow ? still + 1 : 0;
    }
    return steps;
}

Vec3d Block::displacement_at(const Vec3d& rest) const {
    std::array<int, 3> low{};
    Vec3d share;
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const double at = rest[axis] / settings_.cell;
        low[a] = std::clamp(static_cast<int>(std::floor(at)), 0, count_[a] - 1);
        share[axis] = at - low[a];
    }
    Vec3d sum = Vec3d::Zero();
    for (int v = 0; v < 8; ++v) {
        double weight = 1.0;
        for (int axis = 0; axis < 3; ++axis) {
            weight *= (v >> axis & 1) != 0 ? share[axis] : 1.0 - share[axis];
        }
        const std::uint32_t i = index_of(low[0] + (v & 1), low[1] + (v >> 1 & 1), low[2] + (v >> 2 & 1));
        sum += weight * (particles_.position[i].cast<double>() - rest_[i]);
    }
    return sum;
}

Vec3d Block::contact_force() const {
    Vec3d sum = Vec3d::Zero();
    for (const pbd::MeshContact& c : mesh_.contacts) {
        sum += c.force.cast<double>();
    }
    return sum;
}

}  // namespace eti::bench
