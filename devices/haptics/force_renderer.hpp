// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/model/tools.hpp"
#include "devices/haptics/passivity.hpp"
#include "devices/haptics/proxy_prediction.hpp"
#include "devices/haptics/safety.hpp"
#include "devices/haptics/scene_state.hpp"
#include "devices/haptics/soft_force.hpp"

namespace eti::devices {

struct RenderSettings {
    Tool tool = Tool::laryngoscope;  ///< a tube has no proxy: only its own force is felt
    CouplingSettings coupling;
    SafetySettings safety;
    PredictionBounds prediction;
    SoftForce soft_force = SoftForce::constraint;
    PassivitySettings passivity;
    bool torque = true;            ///< the device has it; else turning is resisted by a force at its gimbal
    Vec3f gimbal = Vec3f::Zero();  ///< [m], tool frame; where a device without torque pulls
};

/// From the device's motion and the newest scene to the wrench that the hand feels; one call a cycle.
/// Pure but for the memory of ramp, return and last wrench; allocates nothing, reads no clock.
class ForceRenderer {
  public:
    explicit ForceRenderer(const RenderSettings& settings);

    /// `now` [ns, CLOCK_MONOTONIC], `dt` [s] since the last call.
    Wrench cycle(const Motion& device, const SceneState& scene, std::int64_t now, float dt);

    /// No force, at once; then only after quiet cycles and by the ramp. For a device that cannot be trusted
    /// and for a person who wants it to stop.
    void release();

    [[nodiscard]] const PassivityController& passivity() const { return passivity_; }
    /// Less than all force for want of messages.
    [[nodiscard]] bool stale() const { return freshness_.share() < 1.0f || regrowth_.growing(); }
    [[nodiscard]] bool engaged() const { return engagement_.share() > 0.0f; }
    [[nodiscard]] std::uint64_t not_finite() const {
        return not_finite_;
    }  ///< cycles with a force that was not

  private:
    [[nodiscard]] Wrench rigid_wrench(const Motion& device, const Motion& proxy) const;
    [[nodiscard]] Wrench soft_wrench(const SceneState& scene, const RigidTransform& proxy, float dt,
                                     bool after_gap);
    /// This cycle is the first with a message that came after a gap, or so soon after one that the proxy has
    /// not yet come to where the device is now.
    [[nodiscard]] bool after_gap(const SceneState& scene);
    /// What moves where the device pulls: the tool, or, without torque, the gimbal alone.
    [[nodiscard]] Motion felt(const Motion& device) const;
    [[nodiscard]] Wrench for_device(const Wrench& wrench, const Motion& device,
                                    const SceneState& scene) const;

    RenderSettings settings_;
    Freshness freshness_, tissue_freshness_;
    Regrowth regrowth_;
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
