// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <optional>
#include <vector>

#include "common/model/pace.hpp"
#include "server/patient/model/patient.hpp"
#include "server/patient/model/skeleton.hpp"
#include "server/rigid/rigid_layer.hpp"
#include "server/scene/blade.hpp"
#include "server/scene/posed_shell.hpp"
#include "server/scene/saliva.hpp"
#include "server/scene/shell_clearance.hpp"
#include "server/scene/skeleton/skeleton_coupling.hpp"
#include "server/scene/snapshot.hpp"
#include "server/scene/step_timer.hpp"
#include "server/scene/tissue.hpp"
#include "server/scene/tube.hpp"

namespace eti::scene {

/// Inputs from devices and commands, latched once per step. Patient frame.
struct Inputs {
    RigidTransform laryngoscope;
    RigidTransform tube_grip;
    RuntimeParameters runtime_parameters;  ///< targets, approached at the rates of runtime_parameter_fields
};

struct Settings {
    int substeps = 8;
    TissueMethod tissue_method = TissueMethod::implicit;
    float rate_scale = 1.0f;    ///< scales the rates at which runtime parameters approach their targets
    float head_scale = 1.0f;    ///< with which the model was built
    float tongue_scale = 1.0f;  ///< with which the model was built
    rigid::Settings rigid;
    bool bones_yield = true;    ///< head, mandible and hyoid; only with an implicit mesh
    JointProperties joints{};   ///< of bones that yield, at term
    bool relaxation = false;    ///< stress relaxation; needs an implicit tongue
    bool self_contact = false;  ///< enables contact between tissue and tissue
    bool sleep = true;          ///< skips solving tissue at rest
    bool saliva = false;        ///< enables secretions in mouth and throat; costs nothing when off
    LiquidKind liquid = LiquidKind::saliva;  ///< kind of liquid
    bool dry_start = false;                  ///< with saliva: no liquid until a secretion rate is set
    std::uint64_t seed = 1;                  ///< for the secretion's random numbers
    /// Only tool poses count: the physical manikin stops the tools, and nothing in the simulation does.
    bool manikin = false;
};

/// Patient, laryngoscope, tube and saliva in one simulation. The particle solver computes tissue, rod and
/// liquid; the rigid layer computes the laryngoscope's proxy.
///
/// Not thread safe: the physics thread calls all functions. step() spreads its work over the threads of
/// server/parallel and returns once all of it is done. Other threads get copies of snapshot().
class Scene {
  public:
    Scene(const patient::Patient& patient, const Laryngoscope& scope, const Tube& tube, const Inputs& start,
          const Settings& settings);
    Scene(const Scene&) = delete;  // the shell refers to the bones
    Scene& operator=(const Scene&) = delete;

    /// Advances by one step of 1/180 s, in the stages declared below. Calls `proxy_moved`, on the calling
    /// thread, with the step's proxy as soon as the rigid layer has finished, long before the tissue has.
    void step(const Inputs& inputs, const std::function<void(const ProxySnapshot&)>& proxy_moved = {});

    /// State after the last step; valid until the next.
    [[nodiscard]] const Snapshot& snapshot() const { return snapshot_; }

    [[nodiscard]] const SoftTissue& tissue() const { return tissue_; }
    /// nullptr where bones do not yield.
    [[nodiscard]] const YieldingSkeleton* skeleton() const { return bones_ ? &bones_->skeleton() : nullptr; }
    /// Signed distances [m] of the offset shell in the current posture; negative inside the tissue.
    [[nodiscard]] const DistanceGrid& shell() const { return shell_.distance(); }

    /// Times the stages of subsequent steps with `timer`, which must outlive them; nullptr: none.
    void set_step_timer(StepTimer* timer) { timer_ = timer; }

    /// FNV-1a over the bits of positions and velocities of particles, rod, proxy and liquid, and of the
    /// tissue's relaxation, which lasts for seconds. State that contacts keep between steps is excluded;
    /// differences in it show a step later.
    [[nodiscard]] std::uint64_t state_hash() const;

    /// Restores the initial state of patient and tools, with the tools at `start`. Simulation time continues.
    void reset(const Inputs& start);

    /// Teleports a tool, at rest: used when its device connects, far from where it was parked.
    void place_laryngoscope(const RigidTransform& pose);
    void place_tube(const RigidTransform& grip);

  private:
    /// A substep of a step, and its place in the part of the step that one solve of the tongue covers.
    struct Substep {
        int index = 0;
        int per_solve = 0;               ///< substeps covered by a solve; 0: the tongue does not move
        float dt = 0.0f;                 ///< [s]
        float begin = 0.0f, end = 0.0f;  ///< fractions of the step
        float solved_part = 0.0f;        ///< fraction, at its end, of the part that the solve covers
    };

    // Stages of a step, in order. Each adds its time to the step timer.

    /// Moves the runtime parameters towards `wanted` by at most their change per step. Where they change,
    /// updates gravity, stiffness and rest shape of the tissue, the tube's material, and the shell that the
    /// rigid layer collides with.
    void follow(const RuntimeParameters& wanted);
    /// Moves the shell with the bones that yield.
    void move_shell();
    /// Gathers the loads on bones that yield, and wakes the tongue if it has to move with them.
    void load_bones();
    /// Moves the proxy towards the device, stopped by the shell (with a manikin: to the device). Writes the
    /// ProxySnapshot, whose `last_free` is where the particles' blade moves in this step: its last pose
    /// without penetration of the shell.
    void move_proxy(const Inputs& inputs);
    /// Wakes tissue that a tool may touch on its way, and all of it if the shell's distances changed.
    void wake_near_tools(const Inputs& inputs);
    /// Decides which tissue sleeps, and lists the particles within reach of blade and tube.
    void find_reachable(const Inputs& inputs);
    /// Starts the liquid's step in the background, on copies of tissue and tube as of the last step. Returns
    /// whether there is anything to compute.
    [[nodiscard]] bool begin_saliva();
    /// For each substep: at the first that a solve covers, solves the tongue with its contacts on blade and
    /// shell; writes its particles' path and the blade's impulses.
    void solve_tongue(const Substep& now);
    /// Writes predicted positions: free particles by velocity, those of bones towards rest, the tongue's on
    /// its path; and the rod's.
    void predict(const Substep& now);
    /// Moves predicted positions by clusters, links and other constraints, blade, tube and shell.
    void project(const Substep& now);
    /// Writes positions and velocities, and what pushed the tongue, as springs for its next solve.
    void finish(const Substep& now);
    /// Adopts the tools' poses and writes the rest of the snapshot, except for the liquid.
    void end_step(const Inputs& inputs);

    /// Substeps covered by one solve of the tongue in this step: fewer for a faster blade; 0 while it sleeps.
    [[nodiscard]] int substeps_per_solve() const;
    [[nodiscard]] Substep substep(int index, int per_solve) const;
    /// Whether the tongue's swelling has been computed; the first call starts it and takes half a second.
    [[nodiscard]] bool swelling_ready();
    void wake_tissue() { tissue_.body().sleep.wake_all(tissue_.body().particles); }
    /// Updates what depends on the table's angle.
    void update_gravity();
    /// Sizes of cranium and tongue relative to the model as built.
    [[nodiscard]] float head() const { return live_.head_scale / settings_.head_scale; }
    [[nodiscard]] float growth() const { return live_.tongue_scale / settings_.tongue_scale; }
    [[nodiscard]] static patient::Posture posture_of(const RuntimeParameters& live) {
        return {live.head_elevation, live.jaw_opening, live.table_angle};
    }
    /// Poses of the bones; where they yield, as they are now.
    [[nodiscard]] patient::BonePoses bones_at(const RuntimeParameters& live) const {
        return bones_ ? bones_->skeleton().bones() : patient::pose_bones(patient_.skeleton, posture_of(live));
    }
    /// Keeps the tongue out of palate, gums and pharynx.
    void keep_out_of_shell(pbd::Particles& particles);
    void fill_proxy(const Inputs& inputs);
    void fill_snapshot(const Inputs& inputs);
    void lap(StepStage stage) {
        if (timer_ != nullptr) {
            timer_->lap(stage);
        }
    }
    void fill_saliva();
    /// Surroundings of the saliva while the blade moves to `blade_to`.
    [[nodiscard]] SalivaSurroundings saliva_surroundings(const RigidTransform& blade_to, float suction) const;

    const patient::Patient& patient_;
    Settings settings_;
    RuntimeParameters live_;
    // Swelling of the tongue, computed in the background once another size is requested and adopted a fixed
    // number of steps later, so that a replayed session is bit-identical.
    std::future<std::vector<Vec3f>> swelling_;  // [particles][m]
    int swelling_wait_ = 0;
    Vec3f gravity_ = Vec3f::Zero();  // [m/s^2]
    SoftTissue tissue_;
    std::optional<SkeletonCoupling> bones_;
    YieldingSkeleton::Vector shell_at_ = YieldingSkeleton::Vector::Zero();  // offsets at which the shell is
    PosedShell shell_;
    rigid::RigidLayer rigid_;
    BladeContact blade_;
    Tube built_tube_;  // as in the scenario
    TubeContact tube_;
    std::optional<Saliva> saliva_;
    std::vector<Vec3f> previous_tube_nodes_;      // [nodes][m], one step before the snapshot's
    std::vector<std::uint32_t> shell_particles_;  // indices of particles that collide with the shell
    ShellClearance clearance_;                    // of shell_particles_
    std::uint64_t shell_revision_ = 0;            // revision against which tissue was last woken
    RigidTransform blade_pose_;                   // pose at which the particles last collided with it
    RigidTransform grip_;
    Snapshot snapshot_;
    StepTimer* timer_ = nullptr;
};

}  // namespace eti::scene
