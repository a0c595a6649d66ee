// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/tongue/tongue.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/parallel/loops.hpp"
#include "server/patient/model/patient.hpp"

namespace eti::scene {

namespace {

constexpr float max_blade_way = 1e-3f;  // [m], per solve; 0.18 m/s with one solve per step
constexpr float draw = 0.5f;            // stiffness of the spring to rest over the particle's own

}  // namespace

int Tongue::solve_count(float blade_way, int substeps) {
    int solves = 1;
    while (solves < substeps &&
           (substeps % solves != 0 || blade_way > max_blade_way * static_cast<float>(solves))) {
        ++solves;
    }
    return solves;
}

void Tongue::configure(const pbd::ImplicitMesh::Description& mesh, TongueContacts::Surface surface,
                       pbd::Particles& particles, float substep) {
    substep_ = substep;
    constexpr float lighter = patient::tissue_density / patient::physical_tissue_density;
    std::vector<float> inverse_mass = particles.inverse_mass;
    for (float& w : inverse_mass) {
        w *= lighter;
    }
    mesh_.configure(mesh, particles, inverse_mass);
    moved_.assign(particles.size(), false);
    std::vector<std::uint32_t> movers;
    for (std::size_t k = 0; k < mesh_.particles().size(); ++k) {
        if (mesh_.inverse_mass(k) > 0.0f) {
            movers.push_back(mesh_.particles()[k]);
            moved_[movers.back()] = true;
        }
    }
    std::ranges::sort(movers);
    const auto fixed = [&](std::uint32_t i) { return !moved_[i]; };
    std::erase_if(surface.particles, fixed);
    std::erase_if(surface.triangles,
                  [&](const auto& corners) { return std::ranges::all_of(corners, fixed); });
    const std::size_t movers_count = movers.size();
    contacts_.configure(std::move(movers), std::move(surface));
    // Reserved so that a step does not allocate.
    mesh_.contacts.reserve(contacts_.expected_count());
    mesh_.springs.reserve(3 * movers_count);
    cluster_springs_.reserve(movers_count);
    for (std::vector<Vec3f>* of : {&from_, &to_, &push_}) {
        of->assign(mesh_.particles().size(), Vec3f::Zero());
    }
}

void Tongue::keep_apart(const SelfContactFinder::Description& description) {
    self_contacts_.configure(description);
    mesh_.self_contacts.reserve(self_contacts_.points());
}

void Tongue::set_rest(const pbd::Particles& particles) {
    // Springs left where they were would damp a change of posture: they are as stiff as all that they hold.
    const auto used = mesh_.particles();
    auto spring = cluster_springs_.begin();
    for (std::size_t k = 0; k < used.size(); ++k) {
        const Vec3f moved = particles.rest[used[k]] - mesh_.rest(k);
        if (spring != cluster_springs_.end() && spring->particle == used[k]) {
            spring->to += moved;
            ++spring;
        }
        if (!push_[k].isZero(0.0f)) {
            push_[k] += moved;
        }
    }
    mesh_.set_rest(particles);
}

void Tongue::forget_contacts() {
    contacts_.reset();
    self_contacts_.reset();
    mesh_.contacts.clear();
    mesh_.self_contacts.clear();
}

void Tongue::reset(pbd::Particles& particles) {
    forget_contacts();
    mesh_.forget();
    away_ = relax_end;
    mesh_.springs.clear();
    cluster_springs_.clear();
    std::ranges::fill(push_, Vec3f::Zero());
    set_substep_masses(particles);
}

void Tongue::set_substep_masses(pbd::Particles& particles) const {
    const auto used = mesh_.particles();
    for (std::size_t k = 0; k < used.size(); ++k) {
        if (moved_[used[k]]) {
            particles.inverse_mass[used[k]] = 1.0f / (mesh_.own_stiffness(k) * substep_ * substep_);
        }
    }
}

void Tongue::set_youngs_modulus(std::span<const float> tetrahedra, std::span<const float> hexahedra,
                                pbd::Particles& particles) {
    mesh_.set_youngs_modulus(tetrahedra, hexahedra);
    set_substep_masses(particles);
}

bool Tongue::update_tools_away(bool away) {
    const bool begins = away && away_ == relax_begin;
    away_ = away ? std::min(away_ + 1, relax_end) : 0;
    return begins;
}

void Tongue::gather_springs(const pbd::Particles& particles) {
    mesh_.springs = cluster_springs_;
    const auto used = mesh_.particles();
    const bool drawn = is_drawn();
    mesh_.set_recovering(drawn);  // else dents that it draws out would return
    for (std::size_t k = 0; k < used.size(); ++k) {
        if (drawn && moved_[used[k]]) {
            mesh_.springs.push_back({used[k], particles.rest[used[k]], draw * mesh_.own_stiffness(k), false});
        }
        if (!push_[k].isZero(0.0f)) {
            mesh_.springs.push_back(
                {used[k], particles.position[used[k]] + push_[k], mesh_.own_stiffness(k)});
        }
    }
}

void Tongue::find_contacts(pbd::SoftBody& body, const TongueContacts::MovingBlade& blade, const Walls& walls,
                           float dt, float fraction) {
    pbd::Particles& p = body.particles;
    dt_ = dt;
    const auto used = mesh_.particles();
    for (std::size_t k = 0; k < used.size(); ++k) {
        const std::uint32_t i = used[k];
        from_[k] = p.position[i];
        if (moved_[i]) {
            p.velocity[i] += dt * acceleration;
            p.predicted[i] = p.position[i];
        } else {
            p.predicted[i] = p.position[i] + fraction * (p.rest[i] - p.position[i]);
        }
    }
    gather_springs(p);
    parallel::run_both([&] { mesh_.linearise(p, dt); },
                       [&] {
                           if (is_drawn()) {
                               forget_contacts();  // they may be what keeps it from its rest shape
                               return;
                           }
                           contacts_.find(p, blade, walls, mesh_.contacts);
                           if (self_contacts_.points() > 0) {
                               self_contacts_.find(p, mesh_.self_contacts);
                           }
                       });
}

void Tongue::solve(pbd::SoftBody& body, const RigidTransform& blade, BladeContact& blade_contact) {
    pbd::Particles& p = body.particles;
    mesh_.solve_linearised(p, dt_);
    const auto used = mesh_.particles();
    body.sleep.keep_mesh_awake(mesh_.is_relaxing());
    for (std::size_t k = 0; k < used.size(); ++k) {
        to_[k] = p.predicted[used[k]];
        push_[k].setZero();
    }
    for (std::size_t n = 0; n < mesh_.contacts.size(); ++n) {
        const pbd::MeshContact& c = mesh_.contacts[n];
        if (contacts_.is_with_blade(n) && !c.force.isZero(0.0f)) {
            for (std::size_t e = 0; e < c.corners; ++e) {
                blade_contact.add_impulse(c.particle[e], p.predicted[c.particle[e]],
                                          c.share[e] * dt_ * c.force, blade);
            }
        }
    }
}

void Tongue::place(pbd::Particles& particles, float share) const {
    const auto used = mesh_.particles();
    for (std::size_t k = 0; k < used.size(); ++k) {
        particles.predicted[used[k]] = from_[k] + share * (to_[k] - from_[k]);
    }
}

void Tongue::absorb_contact_displacements(pbd::Particles& particles, float share) {
    const auto used = mesh_.particles();
    for (std::size_t k = 0; k < used.size(); ++k) {
        const Vec3f placed = from_[k] + share * (to_[k] - from_[k]);
        Vec3f& x = particles.predicted[used[k]];
        if (moved_[used[k]] && x != placed) {
            push_[k] += x - placed;
            x = placed;
        }
    }
}

void Tongue::finish(pbd::SoftBody& body, int substeps) {
    pbd::Particles& p = body.particles;
    const float keep = std::exp(-body.settings.damping * dt_) / dt_;
    const auto used = mesh_.particles();
    cluster_springs_.clear();
    for (std::size_t k = 0; k < used.size(); ++k) {
        const std::uint32_t i = used[k];
        p.position[i] = to_[k];
        p.velocity[i] = keep * (to_[k] - from_[k]);
        push_[k] /= static_cast<float>(substeps);
        if (moved_[i] && !body.shapes.clusters_of(i).empty()) {
            const pbd::ShapeMatching::GoalSpring pull = body.shapes.goal_spring(i);
            cluster_springs_.push_back({i, pull.goal, pull.stiffness});
        }
    }
}

}  // namespace eti::scene
