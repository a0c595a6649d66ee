// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/operator/hand.hpp"

namespace eti::devices {

/// When forces begin, and how they end when the scene falls silent.
struct SafetySettings {
    float quiet_force = 0.3f;  ///< [N], a cycle that would exert less is quiet
    int quiet_cycles = 20;     ///< in a row, before forces engage
    float ramp_time = 0.5f;    ///< [s], from no force to all of it
    /// [s] without a message, by which there is no force; larger keeps forces through a late server's gaps,
    /// at the cost of feeling an old scene for as long.
    float silence_limit = 0.020f;
    /// [s] before that limit, over which the force fades. One message of 180 Hz may be lost (11 ms) before
    /// it begins. The fade is faster than the force-rate limit: that is against pushes, this lets go.
    float fade_time = 0.008f;
    [[nodiscard]] float stale_after() const { return silence_limit - fade_time; }
    float recovery_time = 0.1f;  ///< [s], back to all force after a gap that ended before the fade did
};

/// Share of the force that a scene of this age deserves: 1 while messages come, 0 when it is stale.
class Freshness {
  public:
    explicit Freshness(const SafetySettings& settings) : settings_(settings) {}

    /// `age` [s] since the last message arrived; not-a-number or negative counts as stale.
    float update(float age, float dt);
    [[nodiscard]] float share() const { return share_; }

  private:
    SafetySettings settings_;
    float share_ = 0.0f;
};

/// Share of the force that may be exerted at all. At the start, and after a force that was not finite,
/// several quiet cycles in a row must pass, so that nobody is kicked by a device that wakes up inside
/// something (as CHAI3D does); after an outage, as many cycles with a fresh scene, for a hand that is
/// still pressing on something would never be quiet. Then the force ramps up.
class Engagement {
  public:
    explicit Engagement(const SafetySettings& settings) : settings_(settings) {}

    /// `fresh`: there is a scene to feel; `force` [N]: what would be exerted in full.
    float update(bool fresh, float force, float dt);
    void disengage();
    [[nodiscard]] float share() const { return share_; }

  private:
    SafetySettings settings_;
    bool needs_quiet_ = true;
    int cycles_ = 0;
    float share_ = 0.0f;
};

/// `wanted`, but no farther from `last` than the force-rate limit allows in `dt`. The torque's limit
/// follows from it: both reach their range in the same time.
[[nodiscard]] Wrench rate_limited(const Wrench& wanted, const Wrench& last, float dt,
                                  const CouplingSettings& settings);

}  // namespace eti::devices
