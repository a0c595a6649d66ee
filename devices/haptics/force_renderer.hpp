// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "devices/haptics/proxy_prediction.hpp"
#include "devices/haptics/safety.hpp"
#include "devices/haptics/scene_state.hpp"
#include "devices/haptics/soft_force.hpp"

namespace eti::devices {

struct RenderSettings {
    CouplingSettings coupling;
    SafetySettings safety;
    PredictionBounds prediction;
    SoftForce soft_force = SoftForce::constraint;
};

/// From the device's motion and the newest scene to the wrench that the hand feels; one call a cycle.
/// Pure but for the memory of ramp, fade and last wrench; allocates nothing, reads no clock.
class ForceRenderer {
  public:
    explicit ForceRenderer(const RenderSettings& settings);

    /// `now` [ns, CLOCK_MONOTONIC], `dt` [s] since the last call.
    Wrench cycle(const Motion& device, const SceneState& scene, std::int64_t now, float dt);

    [[nodiscard]] bool stale() const { return freshness_.share() < 1.0f; }
    [[nodiscard]] bool engaged() const { return engagement_.share() > 0.0f; }
    [[nodiscard]] std::uint64_t not_finite() const {
        return not_finite_;
    }  ///< cycles with a force that was not

  private:
    [[nodiscard]] Wrench soft_wrench(const SceneState& scene, const RigidTransform& proxy) const;

    RenderSettings settings_;
    Freshness freshness_, tissue_freshness_;
    Engagement engagement_;
    Wrench last_;  // before the fade
    std::uint64_t not_finite_ = 0;
};

}  // namespace eti::devices
