// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/skeleton/skeleton_coupling.hpp"

#include <cmath>

#include "common/model/pace.hpp"

namespace eti::scene {

namespace {

// [m], by which bones move before the tissue that they hold outside the mesh follows. It wakes all tissue on
// bone.
constexpr float hold_distance = 50e-6f;
constexpr float at_rest = 1e-6f;           // [m], the same once the bones are at rest
constexpr float skeleton_arm = 0.1f;       // [m], of angles
constexpr float still_bone_speed = 1e-5f;  // [m/s], or at that arm
constexpr float settled = 1e-5f;           // [m], or at that arm: what muscles have yet to relax
constexpr float counting_load = 1e-3f;     // [N], or at that arm

float scale_of(int coordinate) {
    const bool angle =
        coordinate == YieldingSkeleton::head_extension || coordinate == YieldingSkeleton::jaw_opening;
    return angle ? skeleton_arm : 1.0f;
}

}  // namespace

SkeletonCoupling::SkeletonCoupling(const patient::Patient& patient, const SoftTissue& tissue,
                                   const JointProperties& at_term)
    : patient_(patient), skeleton_(patient, at_term) {
    const std::size_t count = patient.particles.size();
    for (std::uint32_t i = 0; i < count; ++i) {
        hyoid_share_.push_back(skeleton_.hyoid_share(patient.particles.rest[i]));
    }
    in_mesh_.assign(count, false);
    const pbd::ImplicitMesh& mesh = tissue.tongue().mesh();
    for (const std::uint32_t i : mesh.particles()) {
        in_mesh_[i] = true;
    }
    for (const std::uint32_t k : mesh.held()) {
        const std::uint32_t i = mesh.particles()[k];
        of_mesh_.push_back({i, carrier_of(i)});
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        if (patient.particles.mass[i] == 0.0f && !in_mesh_[i]) {
            others_.push_back({i, carrier_of(i)});
        }
    }
}

void SkeletonCoupling::reset(const patient::Posture& posture, SoftTissue& tissue) {
    skeleton_.reset(posture);
    follow(posture, tissue);
    solved_load_.setZero();
}

void SkeletonCoupling::follow(const patient::Posture& posture, SoftTissue& tissue) {
    skeleton_.follow(posture);
    tissue.pose(patient::pose_bones(patient_.skeleton, skeleton_.reachable(posture)));
    tissue.set_bones(skeleton_.bones());
    place(of_mesh_, tissue);
    place(others_, tissue);
    held_at_ = skeleton_.offset();
}

void SkeletonCoupling::place(const std::vector<Held>& held, SoftTissue& tissue) const {
    std::vector<Vec3f>& rest = tissue.body().particles.rest;
    for (const Held& h : held) {
        rest[h.particle] = skeleton_.pose_point(tissue.unposed(h.particle), h.carrier);
    }
}

void SkeletonCoupling::set_hands(float muscle_tone, const Vec3f& laryngeal_pressure) {
    if (muscle_tone != muscle_tone_) {
        muscle_tone_ = muscle_tone;
        tone_changed_ = true;
        skeleton_.set_muscle_tone(muscle_tone);
    }
    laryngeal_pressure_ = laryngeal_pressure;
}

void SkeletonCoupling::gather_loads(const ProxySnapshot& proxy, float contact_stiffness,
                                    const BladeContact& blade, const PosedShell& shell,
                                    const SoftTissue& tissue) {
    skeleton_.unload();
    if (!laryngeal_pressure_.isZero(0.0f)) {
        skeleton_.press_larynx(laryngeal_pressure_);
    }
    float pressing = 0.0f;
    Vec3f normal_force = Vec3f::Zero();
    for (const rigid::Contact& contact : proxy.shell_contacts) {
        pressing += contact.force;
        normal_force += contact.force * contact.normal;
    }
    const Vec3f friction = proxy.shell_force - normal_force;
    for (const rigid::Contact& contact : proxy.shell_contacts) {
        const float share = contact.force / pressing;
        skeleton_.add_contact(skeleton_.columns_at(contact.position, shell.carrier_of(contact.triangle)),
                              -(contact.force * contact.normal + share * friction), contact.normal,
                              contact_stiffness);
    }
    const pbd::Particles& p = tissue.body().particles;
    const auto pass_on = [&](std::uint32_t particle, const Vec3f& force) {
        skeleton_.add_load(skeleton_.columns_at(p.position[particle], carrier_of(particle)), force);
    };
    blade.for_impulses([&](std::uint32_t particle, const Vec3f& impulse) {
        if (!in_mesh_[particle]) {  // the mesh itself passes on what acts on its corners
            pass_on(particle, impulse / step_duration);
        }
    });
    tissue.tongue().for_attachments(p, pass_on);
}

bool SkeletonCoupling::needs_step() const {
    if (tone_changed_) {
        return true;
    }
    const YieldingSkeleton::Vector unrelaxed = skeleton_.unrelaxed();
    for (int c = 0; c < static_cast<int>(YieldingSkeleton::Bodies::coordinates); ++c) {
        const float scale = scale_of(c);
        // NaN must not count as still.
        if (!(scale * std::abs(skeleton_.velocity()[c]) < still_bone_speed) ||
            !(scale * std::abs(unrelaxed[c]) < settled) ||
            !(std::abs(skeleton_.load()[c] - solved_load_[c]) < scale * counting_load)) {
            return true;
        }
    }
    return false;
}

void SkeletonCoupling::begin_solve(SoftTissue& tissue, const Walls& walls, float dt) {
    pbd::YieldingBodies& bodies = tissue.tongue().bodies();
    skeleton_.set_recovering(tissue.tongue().is_drawn());
    skeleton_.write(bodies, dt);
    bodies.jacobian.resize(of_mesh_.size());
    for (std::size_t h = 0; h < of_mesh_.size(); ++h) {
        bodies.jacobian[h] = skeleton_.columns(tissue.unposed(of_mesh_[h].particle), of_mesh_[h].carrier);
    }
    const YieldingSkeleton::Vector since = skeleton_.offset() - walls.motion->at();
    bodies.far_ends.clear();
    bodies.far_ends.reserve(tissue.tongue().mesh().contacts.capacity());  // a step does not allocate
    tissue.tongue().for_wall_contacts([&](pbd::MeshContact& contact) {
        const Vec3f& at = tissue.body().particles.predicted[contact.particle[0]];
        contact.far_end =
            bodies.add_far_end(skeleton_.columns_at(at, walls.motion->carrier_at(walls.in_grid(at))));
        Eigen::Vector4f moved;  // what the walls have yet to follow
        pbd::put(pbd::YieldingBodies::displacement(bodies.far_ends.back(), since), moved);
        contact.gap -= contact.normal.dot(moved.head<3>());
    });
    solved_load_ = skeleton_.load();
    tone_changed_ = false;
}

void SkeletonCoupling::end_solve(SoftTissue& tissue, float dt) {
    skeleton_.advance(tissue.tongue().bodies().step, dt);
    tissue.set_bones(skeleton_.bones());
    place(of_mesh_, tissue);
}

bool SkeletonCoupling::has_moved(float distance, YieldingSkeleton::Vector& last) const {
    float sum = 0.0f;
    for (int c = 0; c < static_cast<int>(YieldingSkeleton::Bodies::coordinates); ++c) {
        sum += scale_of(c) * std::abs(skeleton_.offset()[c] - last[c]);
    }
    if (sum <= distance) {
        return false;
    }
    last = skeleton_.offset();
    return true;
}

void SkeletonCoupling::hold(SoftTissue& tissue) {
    if (!others_.empty() && has_moved(needs_step() ? hold_distance : at_rest, held_at_)) {
        place(others_, tissue);
        tissue.body().sleep.wake(tissue.body().particles, others_.front().particle);
    }
}

}  // namespace eti::scene
