// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "common/math/hash.hpp"
#include "common/model/runtime_parameters.hpp"
#include "server/parallel/loops.hpp"
#include "server/patient/model/swelling.hpp"
#include "server/pbd/contact/self_contact.hpp"
#include "server/scene/friction.hpp"

namespace eti::scene {

namespace {

// [m], by which bones move before the shell follows: its stiffness times this is a tenth of a newton.
constexpr float shell_follows = 5e-6f;
constexpr int swelling_delay = 90;  // [steps]; half a second
constexpr float tissue_weight_share = patient::physical_tissue_density / patient::tissue_density;

template <class Scalar, int rows>
void add(Hash& hash, const Eigen::Matrix<Scalar, rows, 1>& vector) {
    hash.bytes(vector.data(), sizeof(Scalar) * rows);
}
// Of the tongue, and of the muscles that hold the bones (docs/solver/hexahedra.md#relaxation).
constexpr pbd::Relaxation muscle_relaxation{.share = 0.5f, .time = 4.5f};
constexpr float mucosa_stiffness = 40e3f;  // [N/m], of a contact: 20 mm^2 of 1.5 mm and 3 MPa on bone

/// Force [N] of an assistant's fingers on the larynx, patient frame.
Vec3f laryngeal_pressure(const RuntimeParameters& live) {
    return {-live.laryngeal_pressure_right, live.laryngeal_pressure_back, live.laryngeal_pressure_up};
}

/// Contacts of the blade where bones yield.
rigid::Settings compliant(rigid::Settings settings) {
    settings.contact_stiffness = mucosa_stiffness;
    settings.contact_damping = 30.0f;
    // A single contact under the hand's greatest force must not count as penetrating.
    settings.penetration_tolerance = settings.force_limit / settings.contact_stiffness;
    return settings;
}
void add(Hash& hash, const RigidTransform& pose) {
    hash.bytes(pose.rotation.coeffs().data(), 4 * sizeof(float));
    add(hash, pose.translation);
}

}  // namespace

Scene::Scene(const patient::Patient& patient, const Laryngoscope& scope, const Tube& tube,
             const Inputs& start, const Settings& settings)
    : patient_(patient),
      settings_(settings),
      live_{.head_scale = settings.head_scale,
            .tongue_scale = settings.tongue_scale,
            .tissue_stiffness = patient.tissue_stiffness},
      tissue_(patient, settings.tissue_method, step_duration / static_cast<float>(settings.substeps)),
      bones_(settings.bones_yield && !tissue_.tongue().empty()
                 ? std::optional<SkeletonCoupling>(std::in_place, patient, tissue_, settings.joints)
                 : std::nullopt),
      shell_(patient, bones_ ? &bones_->skeleton() : nullptr),
      rigid_(scope, patient.shell.mesh, patient.shell.triangle_tissue,
             bones_ ? compliant(settings.rigid) : settings.rigid),
      blade_(scope, tissue_.surface_edges(), tissue_.tongue().moved()),
      built_tube_(tube),
      tube_(apply_to_tube(tube, start.runtime_parameters), scope, start.tube_grip) {
    if (settings.self_contact) {
        std::vector<std::uint32_t> surface;
        for (const auto& ends : tissue_.surface_edges()) {
            for (const std::uint32_t i : ends) {
                if (tissue_.tissue_of(i) != Tissue::soft) {  // particles that the shell does not keep out of
                                                             // the tongue's way
                    surface.push_back(i);
                }
            }
        }
        std::ranges::sort(surface);
        const auto repeated = std::ranges::unique(surface);
        surface.erase(repeated.begin(), repeated.end());
        pbd::SelfContact contact;
        contact.configure(std::move(surface), patient.clusters.first, patient.clusters.member,
                          tissue_.body().particles);
        tissue_.body().constraints.emplace_back(std::move(contact));
    }
    if (settings.saliva) {
        saliva_.emplace(patient, scope, 0.5f * tube.outer_diameter, settings.seed, settings.liquid);
    }
    const pbd::Particles& particles = tissue_.body().particles;
    for (std::uint32_t i = 0; i < particles.size(); ++i) {
        if ((particles.channels[i] & pbd::channel::shell) != 0 && particles.inverse_mass[i] > 0.0f &&
            !tissue_.tongue().moves(i)) {
            shell_particles_.push_back(i);
        }
    }
    if (settings.relaxation) {
        tissue_.relax(muscle_relaxation);
        if (bones_) {
            bones_->relax(muscle_relaxation);
        }
    }
    if (settings.sleep) {
        tissue_.enable_sleeping();
    }
    snapshot_.tissue_contacts.reserve(particles.size());  // a step does not allocate
    reset(start);
}

void Scene::reset(const Inputs& start) {
    const RuntimeParameters before = std::exchange(live_, clamped(start.runtime_parameters));
    update_gravity();
    if (live_.tongue_scale != before.tongue_scale) {
        if (!tissue_.has_swelling()) {
            tissue_.set_swelling(swelling_.valid() ? swelling_.get() : patient::tongue_swelling(patient_));
        }
        tissue_.set_tongue_growth(growth());
    }
    if (live_.tissue_stiffness != before.tissue_stiffness) {
        tissue_.set_stiffness(live_.tissue_stiffness);
    }
    tube_.set_material(apply_to_tube(built_tube_, live_));
    if (bones_) {
        bones_->set_hands(live_.muscle_tone, laryngeal_pressure(live_));
        bones_->reset(posture_of(live_), tissue_);
        shell_at_.setZero();
    } else {
        tissue_.pose(bones_at(live_));
    }
    tissue_.reset();
    shell_.pose_now(bones_at(live_));
    rigid_.move_shell(shell_.vertices());
    place_laryngoscope(start.laryngoscope);
    place_tube(start.tube_grip);
    fill_proxy(start);
    fill_snapshot(start);
    if (saliva_) {
        saliva_->reset(saliva_surroundings(start.laryngoscope, 0.0f), settings_.dry_start);
        fill_saliva();
    }
}

void Scene::place_laryngoscope(const RigidTransform& pose) {
    rigid_.reset(pose);
    blade_.reset();
    blade_pose_ = pose;
    wake_tissue();  // tissue on which the blade pressed
}

void Scene::place_tube(const RigidTransform& grip) {
    tube_.reset(grip);
    grip_ = grip;
    wake_tissue();
    previous_tube_nodes_.clear();
}

void Scene::follow(const RuntimeParameters& wanted) {
    RuntimeParameters to = clamped(wanted);
    if (to.tongue_scale != live_.tongue_scale && !swelling_ready()) {
        to.tongue_scale = live_.tongue_scale;
    }
    const RuntimeParameters before =
        std::exchange(live_, advance_towards(live_, to, step_duration, settings_.rate_scale));
    if (live_.table_angle != before.table_angle) {
        update_gravity();
    }
    if (live_.tissue_stiffness != before.tissue_stiffness) {
        tissue_.set_stiffness(live_.tissue_stiffness);
    }
    if (live_.tube_youngs_modulus != before.tube_youngs_modulus ||
        live_.tube_curve_radius != before.tube_curve_radius) {
        tube_.set_material(apply_to_tube(built_tube_, live_));
    }
    if (bones_) {
        bones_->set_hands(live_.muscle_tone, laryngeal_pressure(live_));
    }
    const bool tongue_grows = live_.tongue_scale != before.tongue_scale;
    if (tongue_grows) {
        tissue_.set_tongue_growth(growth());
    }
    const bool bones_move =
        live_.head_elevation != before.head_elevation || live_.jaw_opening != before.jaw_opening;
    if (!bones_move && !tongue_grows) {
        return;
    }
    if (bones_) {
        bones_->follow(posture_of(live_), tissue_);
    } else {
        tissue_.pose(bones_at(live_));
    }
    if (bones_move) {
        shell_.pose(bones_at(live_));
        rigid_.move_shell(shell_.vertices());
    }
}

void Scene::move_shell() {
    if (bones_ && bones_->has_moved(shell_follows, shell_at_)) {
        shell_.yield();
        rigid_.move_shell(shell_.vertices());
    }
}

void Scene::load_bones() {
    if (!bones_) {
        return;
    }
    bones_->gather_loads(snapshot_, mucosa_stiffness, blade_, shell_, tissue_);
    pbd::SoftBody& body = tissue_.body();
    if (!body.sleep.mesh_awake() && bones_->needs_step()) {
        body.sleep.wake(body.particles, tissue_.tongue().any_moved());
    }
    bones_->hold(tissue_);
}

bool Scene::swelling_ready() {
    if (tissue_.has_swelling()) {
        return true;
    }
    if (!swelling_.valid()) {
        swelling_ = std::async(std::launch::async, [this] { return patient::tongue_swelling(patient_); });
        swelling_wait_ = swelling_delay;
    }
    if (--swelling_wait_ > 0) {
        return false;
    }
    tissue_.set_swelling(swelling_.get());
    return true;
}

void Scene::update_gravity() {
    gravity_ = patient::gravity(live_.table_angle);
    const Vec3f turned = gravity_ - patient::gravity(0.0f);
    tissue_.body().settings.acceleration = tissue_weight_share * turned;
    tissue_.tongue().acceleration = turned;
    wake_tissue();
}

void Scene::step(const Inputs& inputs, const std::function<void(const ProxySnapshot&)>& proxy_moved) {
    if (timer_ != nullptr) {
        timer_->start();
    }
    follow(inputs.runtime_parameters);
    shell_.advance();
    move_shell();
    move_proxy(inputs);
    if (proxy_moved) {
        proxy_moved(snapshot_);
    }
    lap(StepStage::rigid);
    if (settings_.manikin) {
        tube_.reset(inputs.tube_grip);
        end_step(inputs);
        return;
    }

    load_bones();
    wake_near_tools(inputs);
    find_reachable(inputs);
    const bool liquid_moves = begin_saliva();
    lap(StepStage::reach);
    const int per_solve = substeps_per_solve();
    for (int s = 0; s < settings_.substeps; ++s) {
        const Substep now = substep(s, per_solve);
        solve_tongue(now);
        predict(now);
        project(now);
        finish(now);
    }
    end_step(inputs);
    tissue_.body().end_step();
    if (liquid_moves) {
        saliva_->end_step();
        fill_saliva();
    }
}

void Scene::move_proxy(const Inputs& inputs) {
    if (settings_.manikin) {
        rigid_.reset(inputs.laryngoscope);
    } else {
        rigid_.step(inputs.laryngoscope, step_duration);
    }
    ++snapshot_.step;
    // Whole nanoseconds from the step number: no drift.
    snapshot_.time_ns = time_ns_of(snapshot_.step);
    fill_proxy(inputs);
}

void Scene::wake_near_tools(const Inputs& inputs) {
    if (shell_revision_ != shell_.revision()) {
        shell_revision_ = shell_.revision();
        wake_tissue();
    }
    if (tissue_.tongue().update_tools_away(!blade_.reaches_tissue() && !tube_.reaches_tissue())) {
        wake_tissue();  // tissue wound about itself may have fallen asleep while a tool was near
    }
    blade_.wake(tissue_.body(), blade_pose_, snapshot_.last_free);
    tube_.wake(tissue_.body(), grip_, inputs.tube_grip);
}

void Scene::find_reachable(const Inputs& inputs) {
    pbd::SoftBody& body = tissue_.body();
    body.begin_step();
    const RigidTransform& blade_to = snapshot_.last_free;
    parallel::run_both(
        [&] { blade_.begin_step(body.particles, blade_pose_, blade_to); },
        [&] { tube_.begin_step(body.particles, grip_, inputs.tube_grip, blade_pose_, blade_to); });
}

bool Scene::begin_saliva() {
    if (!saliva_ || !saliva_->flows(live_.secretion)) {
        return false;
    }
    saliva_->begin_step(saliva_surroundings(snapshot_.last_free, live_.suction));
    return true;
}

int Scene::substeps_per_solve() const {
    if (tissue_.tongue().empty() || !tissue_.body().sleep.mesh_awake()) {
        return 0;
    }
    return settings_.substeps / Tongue::solve_count(blade_.travel(), settings_.substeps);
}

Scene::Substep Scene::substep(int index, int per_solve) const {
    const auto count = static_cast<float>(settings_.substeps);
    Substep now{.index = index,
                .per_solve = per_solve,
                .dt = step_duration / count,
                .begin = static_cast<float>(index) / count,
                .end = static_cast<float>(index + 1) / count};
    if (per_solve > 0) {
        now.solved_part = static_cast<float>(index % per_solve + 1) / static_cast<float>(per_solve);
    }
    return now;
}

void Scene::solve_tongue(const Substep& now) {
    if (now.per_solve == 0 || now.index % now.per_solve != 0) {
        return;
    }
    const auto covered = static_cast<float>(now.per_solve);
    const float until =
        static_cast<float>(now.index + now.per_solve) / static_cast<float>(settings_.substeps);
    const float dt = now.dt * covered;
    Tongue& tongue = tissue_.tongue();
    const TongueContacts::MovingBlade blade{blade_.scope(), blade_.pose_at(now.begin), blade_.pose_at(until)};
    tongue.find_contacts(tissue_.body(), blade, shell_.walls(), dt,
                         covered / static_cast<float>(settings_.substeps - now.index));
    if (bones_) {
        bones_->begin_solve(tissue_, shell_.walls(), dt);
    }
    tongue.solve(tissue_.body(), blade.to, blade_);
    if (bones_) {
        bones_->end_solve(tissue_, dt);
    }
    lap(StepStage::tissue);
}

void Scene::predict(const Substep& now) {
    tissue_.body().predict(now.dt, 1.0f / static_cast<float>(settings_.substeps - now.index));
    if (now.per_solve > 0) {
        tissue_.tongue().place(tissue_.body().particles, now.solved_part);
    }
    tube_.predict(now.dt, now.end, gravity_);
    lap(StepStage::predict);
}

void Scene::project(const Substep& now) {
    pbd::SoftBody& body = tissue_.body();
    const auto tissue = [&] {
        body.project(now.dt);
        lap(StepStage::tissue);
        blade_.project(body.particles, now.begin, now.end, now.dt);
        lap(StepStage::blade);
    };
    const auto tube = [&] { tube_.project(body.particles, shell_.walls(), now.begin, now.end); };
    // With a timer, sequentially, to measure each.
    if (tube_.reaches_tissue() || timer_ != nullptr) {
        tissue();
        tube();
        lap(StepStage::tube);
    } else {
        parallel::run_both(tissue, tube);
    }
    keep_out_of_shell(body.particles);
    lap(StepStage::shell);
}

void Scene::finish(const Substep& now) {
    pbd::SoftBody& body = tissue_.body();
    if (now.per_solve > 0) {
        tissue_.tongue().absorb_contact_displacements(body.particles, now.solved_part);
    }
    tube_.finish();
    body.finish(now.dt);
    if (now.per_solve > 0 && (now.index + 1) % now.per_solve == 0) {
        tissue_.tongue().finish(body, now.per_solve);
    }
    lap(StepStage::finish);
}

void Scene::end_step(const Inputs& inputs) {
    blade_pose_ = snapshot_.last_free;
    grip_ = inputs.tube_grip;
    previous_tube_nodes_ = snapshot_.tube_nodes;
    fill_snapshot(inputs);
}

SalivaSurroundings Scene::saliva_surroundings(const RigidTransform& blade_to, float suction) const {
    // Tissue and tube as of the last step, a tenth of a millimetre behind at the speed of most hands.
    const std::vector<Vec3f>& to = snapshot_.tube_nodes;
    return {shell_.distance(),
            shell_.revision(),
            tissue_.body().particles,
            bones_at(live_),
            snapshot_.landmarks,
            blade_pose_,
            blade_to,
            previous_tube_nodes_.size() == to.size() ? previous_tube_nodes_ : to,
            to,
            suction,
            gravity_,
            live_.secretion};
}

void Scene::fill_saliva() {
    const pbd::Fluid& fluid = saliva_->fluid();
    SalivaState& s = snapshot_.saliva;
    s.on = true;
    s.spacing = fluid.settings().spacing;
    s.lower = fluid.settings().lower;
    s.upper = fluid.settings().upper;
    s.positions.assign(fluid.positions().begin(), fluid.positions().end());
    s.overflow = fluid.overflow();
    s.left = fluid.left_domain();
    s.aspirated = fluid.aspirated();
    s.dropped_neighbours = fluid.dropped_neighbours();
}

void Scene::keep_out_of_shell(pbd::Particles& particles) {
    if (particles.awake.empty()) {
        return;
    }
    const Walls walls = shell_.walls();
    clearance_.begin(shell_particles_.size(), walls);
    parallel::for_each(shell_particles_.size(), 256, [&](std::size_t k) {
        const std::uint32_t i = shell_particles_[k];
        if (particles.asleep[i] != 0) {
            return;
        }
        Vec3f& p = particles.predicted[i];
        if (clearance_.inside(k, p, walls)) {
            const Vec3f in_grid = walls.in_grid(p);
            p += pbd::push_out_of(walls.grid, particles.position[i] + (in_grid - p), in_grid, 0.0f,
                                  mucosa_on_mucosa);
        }
    });
}

void Scene::fill_proxy(const Inputs& inputs) {
    const rigid::ProxyResult& proxy = rigid_.result();
    ProxySnapshot& s = snapshot_;
    s.device = inputs.laryngoscope;
    s.proxy = proxy.pose;
    s.last_free = proxy.last_free;
    s.proxy_velocity = proxy.velocity;
    s.proxy_angular_velocity = proxy.angular_velocity;
    s.shell_force = proxy.force;
    s.shell_torque = proxy.torque;
    s.shell_contacts = proxy.contacts;
}

void Scene::fill_snapshot(const Inputs& inputs) {
    Snapshot& s = snapshot_;
    blade_.end_step(tissue_.body().particles, step_duration, s);
    s.tube_grip = inputs.tube_grip;
    tube_.nodes(s.tube_nodes);
    const pbd::GripWrench grip = tube_.grip_wrench();
    s.tube_force = grip.force;
    s.tube_torque = grip.torque;
    tissue_.frames(s.frames, head());
    const auto carried = [&](const patient::CarriedPoint& point) {
        return skin_point(point.rest, point.skin, patient_.frame_rest_centre, s.frames);
    };
    for (std::size_t i = 0; i < landmark_count; ++i) {
        s.landmarks[i] = carried(patient_.landmarks[i]);
    }
    s.glottis_contour.resize(patient_.glottis_contour.size());
    for (std::size_t i = 0; i < s.glottis_contour.size(); ++i) {
        s.glottis_contour[i] = carried(patient_.glottis_contour[i]);
    }
    s.runtime_parameters = live_;
    lap(StepStage::snapshot);
}

std::uint64_t Scene::state_hash() const {
    Hash hash;
    hash.add(std::span<const Vec3f>(tissue_.body().particles.position));
    hash.add(std::span<const Vec3f>(tissue_.body().particles.velocity));
    hash.add(tissue_.tongue().mesh().memory().metrics());  // nothing without relaxation
    for (const pbd::RodSegment& segment : tube_.rod().segments()) {
        add(hash, segment.position);
        add(hash, Eigen::Vector4d(segment.rotation.coeffs()));
        add(hash, segment.velocity);
        add(hash, segment.angular_velocity);
    }
    if (bones_) {
        add(hash, bones_->skeleton().offset());
        add(hash, bones_->skeleton().velocity());
        add(hash, bones_->skeleton().unrelaxed());
    }
    add(hash, snapshot_.proxy);
    add(hash, snapshot_.last_free);
    add(hash, snapshot_.proxy_velocity);
    add(hash, snapshot_.proxy_angular_velocity);
    if (saliva_) {
        hash.add(saliva_->fluid().positions());
        hash.add(saliva_->fluid().velocities());
    }
    return hash.value();
}

}  // namespace eti::scene
