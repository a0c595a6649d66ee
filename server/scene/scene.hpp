// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>

#include "server/anatomy/patient.hpp"
#include "server/anatomy/skeleton.hpp"
#include "server/rigid/rigid_layer.hpp"
#include "server/scene/blade.hpp"
#include "server/scene/posed_shell.hpp"
#include "server/scene/snapshot.hpp"
#include "server/scene/tissue.hpp"
#include "server/scene/tube.hpp"

namespace eti::scene {

/// Simulation steps per second; a snapshot goes out every second step.
inline constexpr int steps_per_second = 180;
inline constexpr float step_duration = 1.0f / steps_per_second;  ///< [s]

/// What devices and commands ask for, latched once per step. Patient frame.
struct Inputs {
    RigidTransform laryngoscope;
    RigidTransform tube_grip;
    float suction = 0.0f;      ///< 0..1
    anatomy::Posture posture;  ///< wanted; approached smoothly
};

struct Settings {
    int substeps = 8;
    float posture_rate = 0.17f;  ///< [rad/s]; a nurse tilts a head at about 10 deg/s
    rigid::Settings rigid;
};

/// Patient, laryngoscope and tube in one simulation: particles and rod from the particle solver, the
/// laryngoscope's proxy from the rigid layer.
class Scene {
  public:
    Scene(const anatomy::Patient& patient, const Laryngoscope& scope, const Tube& tube, const Inputs& start,
          const Settings& settings);

    /// Advances by one step of 1/180 s.
    void step(const Inputs& inputs);

    /// State after the last step. Valid until the next.
    [[nodiscard]] const Snapshot& snapshot() const { return snapshot_; }

    /// FNV-1a over the bits of all particle, rod and proxy state.
    [[nodiscard]] std::uint64_t state_hash() const;

    /// Patient and tools as at the start, with the tools at `start`. Simulation time goes on.
    void reset(const Inputs& start);

    /// Puts a tool somewhere at once, at rest: when its device appears, far from where it was parked.
    void place_laryngoscope(const RigidTransform& pose);
    void place_tube(const RigidTransform& grip);

  private:
    void apply_posture(const anatomy::Posture& posture);
    /// The tongue does not go through palate, gums and pharynx.
    void keep_out_of_shell(pbd::Particles& particles) const;
    void fill_snapshot(const Inputs& inputs);

    const anatomy::Patient& patient_;
    Settings settings_;
    anatomy::Posture posture_;
    SoftTissue tissue_;
    PosedShell shell_;
    rigid::RigidLayer rigid_;
    BladeContact blade_;
    TubeContact tube_;
    RigidTransform blade_pose_;  // where the particles last met it
    RigidTransform grip_;
    Snapshot snapshot_;
};

}  // namespace eti::scene
