// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/model/tools/tools.hpp"
#include "devices/haptics/passivity.hpp"
#include "devices/haptics/proxy_prediction.hpp"
#include "devices/haptics/safety.hpp"
#include "devices/haptics/scene_state.hpp"
#include "devices/haptics/soft_force.hpp"

namespace eti::devices {

struct RenderSettings {
    Tool tool = Tool::laryngoscope;  ///< a tube has no proxy: only its own force is rendered
    CouplingSettings coupling;
    SafetySettings safety;
    PredictionBounds prediction;
    SoftForce soft_force = SoftForce::constraint;
    PassivitySettings passivity;
    bool torque = true;            ///< the device has torque; else a force at its gimbal resists rotation
    Vec3f gimbal = Vec3f::Zero();  ///< [m], tool frame; attachment point of a device without torque
};

/// Computes the rendered wrench from the device's motion and the newest scene; one call per cycle. Its only
/// state is ramp, recovery and last wrench; it allocates nothing and reads no clock.
class ForceRenderer {
  public:
    explicit ForceRenderer(const RenderSettings& settings);

    /// `now` [ns, CLOCK_MONOTONIC], `dt` [s] since the last call.
    Wrench cycle(const Motion& device, const SceneState& scene, std::int64_t now, float dt);

    /// Removes the force at once; it re-engages only after quiet cycles and by the ramp. For an untrusted
    /// device and for an emergency stop.
    void release();

    [[nodiscard]] const PassivityController& passivity() const { return passivity_; }
    /// Whether the force is reduced for lack of messages.
    [[nodiscard]] bool stale() const { return freshness_.share() < 1.0f || recovery_ramp_.active(); }
    [[nodiscard]] bool engaged() const { return engagement_.share() > 0.0f; }
    [[nodiscard]] std::uint64_t not_finite() const {
        return not_finite_;
    }  ///< cycles with a non-finite force

  private:
    [[nodiscard]] Wrench rigid_wrench(const Motion& device, const Motion& proxy) const;
    [[nodiscard]] Wrench soft_wrench(const SceneState& scene, const RigidTransform& proxy, float dt,
                                     bool after_gap);
    /// Whether this cycle is the first with a message that came after a gap, or soon enough after one that
    /// the proxy has not yet caught up with the device.
    [[nodiscard]] bool after_gap(const SceneState& scene);
    /// Motion of the point where the force acts: the tool, or, without torque, the gimbal.
    [[nodiscard]] Motion felt(const Motion& device) const;
    [[nodiscard]] Wrench for_device(const Wrench& shell, const Wrench& tissue, const Motion& device,
                                    const SceneState& scene) const;

    RenderSettings settings_;
    Freshness freshness_, tissue_freshness_;
    ForceRecoveryRamp recovery_ramp_;
    Engagement engagement_;
    SmoothSoftForce soft_;
    PassivityController passivity_;
    RecentSpeeds speeds_;
    Wrench last_;
    std::int64_t proxy_arrived_ = 0, tissue_arrived_ = 0;  // [ns], as of the last cycle
    std::int64_t gap_ended_ = 0;                           // [ns]
    std::uint64_t not_finite_ = 0;
};

}  // namespace eti::devices
