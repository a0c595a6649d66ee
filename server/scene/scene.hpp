// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <limits>
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
#include "server/scene/snapshot.hpp"
#include "server/scene/stage_clock.hpp"
#include "server/scene/tissue.hpp"
#include "server/scene/tube.hpp"

namespace eti::scene {

/// What devices and commands ask for, latched once per step. Patient frame.
struct Inputs {
    RigidTransform laryngoscope;
    RigidTransform tube_grip;
    LiveValues live;  ///< wanted, and followed at the rates of live_fields
};

struct Settings {
    int substeps = 8;
    TissueMethod tissue_method = TissueMethod::implicit;
    float haste = 1.0f;         ///< times the rates at which what lives is followed
    float head_scale = 1.0f;    ///< that the model was built with
    float tongue_scale = 1.0f;  ///< the same
    /// [Pa], that the solver bears in the built tongue, and so much less as that grows. Stiffness and size
    /// wait for each other where both change.
    float stiffest = std::numeric_limits<float>::infinity();
    rigid::Settings rigid;
    bool self_contact = false;  ///< tissue also meets tissue
    bool sleep = true;          ///< tissue at rest is not solved
    bool saliva = false;        ///< secretions in mouth and throat; without them they cost nothing
    LiquidKind liquid = LiquidKind::saliva;  ///< what the secretions are
    bool dry_start = false;                  ///< with saliva: none before glands are told to give some
    std::uint64_t seed = 1;                  ///< of what the glands give
    /// Only where the tools are counts: the manikin stops them, and nothing here does.
    bool manikin = false;
};

/// Patient, laryngoscope, tube and saliva in one simulation: particles, rod and liquid from the particle
/// solver, the laryngoscope's proxy from the rigid layer.
class Scene {
  public:
    Scene(const anatomy::Patient& patient, const Laryngoscope& scope, const Tube& tube, const Inputs& start,
          const Settings& settings);

    /// Advances by one step of 1/180 s. `proxy_moved` gets the step's proxy as soon as the rigid layer is
    /// done, which is most of the step before the tissue is.
    void step(const Inputs& inputs, const std::function<void(const ProxySnapshot&)>& proxy_moved = {});

    /// State after the last step. Valid until the next.
    [[nodiscard]] const Snapshot& snapshot() const { return snapshot_; }

    [[nodiscard]] const SoftTissue& tissue() const { return tissue_; }
    /// The offset shell's distances in the current posture [m]; negative inside the tissue.
    [[nodiscard]] const DistanceGrid& shell() const { return shell_.distance(); }

    /// Times the stages of every further step with `clock`, which has to outlive them; nullptr: none.
    void time_stages(StageClock* clock) { clock_ = clock; }

    /// FNV-1a over the bits of places and velocities of particles, rod, proxy and liquid. What contacts
    /// remember from step to step is not among them, and shows in them a step later.
    [[nodiscard]] std::uint64_t state_hash() const;

    /// Patient and tools as at the start, with the tools at `start`. Simulation time goes on.
    void reset(const Inputs& start);

    /// Puts a tool somewhere at once, at rest: when its device appears, far from where it was parked.
    void place_laryngoscope(const RigidTransform& pose);
    void place_tube(const RigidTransform& grip);

  private:
    /// A step in which both tools are where their devices are, and nothing gives way.
    void follow_tools(const Inputs& inputs, const std::function<void(const ProxySnapshot&)>& proxy_moved);
    /// Carries on what lives towards what is wanted, by what may change in a step.
    void follow(const LiveValues& wanted);
    /// What the solver bears of what is wanted. Stiffness and size of the tongue wait for each other.
    [[nodiscard]] LiveValues borne(LiveValues wanted) const;
    /// Whether it is known how the tongue grows; the first to ask waits half a second.
    [[nodiscard]] bool may_grow();
    void wake_tissue() { tissue_.body().sleep.wake_whole(tissue_.body().particles); }
    /// What hangs on the table's angle.
    void turn_gravity();
    /// Sizes of cranium and tongue against the built ones.
    [[nodiscard]] float head() const { return live_.head_scale / settings_.head_scale; }
    [[nodiscard]] float growth() const { return live_.tongue_scale / settings_.tongue_scale; }
    [[nodiscard]] anatomy::BonePoses bones_at(const LiveValues& live) const {
        return anatomy::pose_bones(patient_.skeleton,
                                   {live.head_elevation, live.jaw_opening, live.table_angle});
    }
    /// The tongue does not go through palate, gums and pharynx.
    void keep_out_of_shell(pbd::Particles& particles);
    void fill_proxy(const Inputs& inputs);
    void fill_snapshot(const Inputs& inputs);
    void lap(Stage stage) {
        if (clock_ != nullptr) {
            clock_->lap(stage);
        }
    }
    void fill_saliva();
    /// What saliva meets while the blade goes to `blade_to`.
    [[nodiscard]] SalivaSurroundings about_saliva(const RigidTransform& blade_to, float suction) const;

    const anatomy::Patient& patient_;
    Settings settings_;
    LiveValues live_;
    // How the tongue grows, computed beside the simulation once someone asks for another size and taken over
    // a set number of steps later, so that a session re-runs to the same bits.
    std::future<std::vector<Vec3f>> swelling_;
    int swelling_wait_ = 0;
    Vec3f gravity_ = Vec3f::Zero();  // [m/s^2]
    SoftTissue tissue_;
    PosedShell shell_;
    rigid::RigidLayer rigid_;
    BladeContact blade_;
    Tube made_;  // as the scenario has it
    TubeContact tube_;
    std::optional<Saliva> saliva_;
    std::vector<Vec3f> tube_before_;          // its nodes, a step before the snapshot's
    std::vector<std::uint32_t> meets_shell_;  // particles
    ShellClearance clearance_;                // of these
    std::uint64_t shell_revision_ = 0;        // that tissue was awake to meet
    RigidTransform blade_pose_;               // where the particles last met it
    RigidTransform grip_;
    Snapshot snapshot_;
    StageClock* clock_ = nullptr;
};

}  // namespace eti::scene
