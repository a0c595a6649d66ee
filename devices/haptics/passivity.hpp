// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/device/coupling.hpp"

namespace eti::devices {

struct PassivitySettings {
    bool on = true;
    /// [N s/m], most that the controller damps with: a device of 0.15 kg sampled at 1 kHz bears well over
    /// 100, and noise in its velocity of 1 mm/s then makes 0.02 N.
    float most_damping = 20.0f;
    float arm = 0.05f;         ///< [m], what turning weighs against moving
    float most_stored = 0.1f;  ///< [J]; the coupling's spring at the device's limit stores 0.04, tissue the
                               ///< rest. What was put in beyond it was lost, and is not lent again
    float idle_force = 0.02f;  ///< [N]; less for
    float idle_time = 0.05f;   ///< [s] ends a contact, and its account is closed
};

/// Passivity observer and controller in the time domain (Hannaford & Ryu, IEEE Trans Robot Autom 2002;18:1),
/// impedance causality, with force and torque as one port. The wrench is constant over a cycle, so the work
/// of the last one over the way measured since is exact (Ryu, Preusche, Hannaford & Hirzinger 2005). When
/// what is rendered has given more than it took, the controller takes the difference back by a damping.
class PassivityController {
  public:
    explicit PassivityController(const PassivitySettings& settings = {}) : settings_(settings) {}

    /// `wanted` with the controller's damping; `device` as just read, `dt` [s] since the last call. Not
    /// `steady`: the wrench fades or ramps up. What that gives is meant, bounded, and no oscillation, so it
    /// is not asked back.
    Wrench apply(const Wrench& wanted, const Motion& device, float dt, bool steady = true);

    /// What was exerted in the end, where it differs from what apply() returned (limits).
    void exerted(const Wrench& wrench) { last_ = wrench; }

    /// [J] that the hand has given and not got back in this contact; negative: it was given energy.
    [[nodiscard]] double stored() const { return stored_; }
    [[nodiscard]] double lowest() const { return lowest_; }          ///< [J], of stored(), so far
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
