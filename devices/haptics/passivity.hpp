// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/device/coupling.hpp"

namespace eti::devices {

struct PassivitySettings {
    bool on = true;
    /// [N s/m], maximum damping of the controller. A device of 0.15 kg sampled at 1 kHz is stable at well
    /// over 100; velocity noise of 1 mm/s then causes 0.02 N.
    float max_damping = 20.0f;
    float arm = 0.05f;         ///< [m], weight of rotation relative to translation
    float max_stored = 0.1f;   ///< [J], cap of the account; the coupling's spring at the device's limit
                               ///< stores 0.04, tissue the rest. Energy above the cap is lost and not
                               ///< returned
    float idle_force = 0.02f;  ///< [N]; a force below this for
    float idle_time = 0.05f;   ///< [s] ends a contact and resets its energy account
};

/// Time-domain passivity observer and controller (Hannaford & Ryu, IEEE Trans Robot Autom 2002;18:1),
/// impedance causality, with force and torque as one port. The wrench is constant over a cycle, so the work
/// of the last wrench over the displacement measured since is exact (Ryu, Preusche, Hannaford & Hirzinger
/// 2005). When the rendered forces have released more energy than they absorbed, the controller dissipates
/// the difference by damping.
class PassivityController {
  public:
    explicit PassivityController(const PassivitySettings& settings = {}) : settings_(settings) {}

    /// `wanted` with the controller's damping; `device` as just read, `dt` [s] since the last call. `steady`
    /// is false while the wrench fades or ramps up. Energy released then is intended, bounded and no
    /// oscillation, so it is not dissipated.
    Wrench apply(const Wrench& wanted, const Motion& device, float dt, bool steady = true);

    /// The wrench actually exerted, where it differs from the result of apply() (limits).
    void exerted(const Wrench& wrench) { last_ = wrench; }

    /// [J], energy absorbed from the hand and not yet returned in this contact; negative: net energy
    /// released.
    [[nodiscard]] double stored() const { return stored_; }
    [[nodiscard]] double lowest() const { return lowest_; }          ///< [J], minimum of stored() so far
    [[nodiscard]] double dissipated() const { return dissipated_; }  ///< [J], by the controller so far
    [[nodiscard]] std::uint64_t active_cycles() const { return active_; }

  private:
    PassivitySettings settings_;
    RigidTransform pose_;
    Wrench last_, damping_;
    bool any_ = false;
    double stored_ = 0.0, lowest_ = 0.0, dissipated_ = 0.0;
    float idle_ = 0.0f;  // [s]
    std::uint64_t active_ = 0;
};

}  // namespace eti::devices
