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
    /// [s]; a later cycle counts for no more where force grows: in its rate, its ramp, its coming back.
    float longest_cycle = 0.002f;
    float longest_pause = 0.025f;  ///< [s] without a cycle; after more, force begins anew by the ramp
    /// [s] without a message, by which there is no force; larger keeps forces through a late server's gaps,
    /// at the cost of feeling an old scene for as long.
    float silence_limit = 0.020f;
    /// [s] before that limit, over which the force fades. Two messages of 180 Hz in a row may be lost
    /// (16.7 ms) before it begins. The fade is faster than the force-rate limit: that is against pushes, this
    /// lets go.
    float fade_time = 0.003f;
    [[nodiscard]] float stale_after() const { return silence_limit - fade_time; }
    /// [s] in which no gap between messages was long enough for a fade, before what faded begins to come
    /// back. Less, and a late server's gaps make the force come and go, and the hand with it.
    float recovery_wait = 0.5f;
    /// [s], from no force to all of it: a light grip (150 N/m) that presses 4 mm into the wall is pushed back
    /// by less than the 0.3 mm in a fifth of a second that count as moving.
    float recovery_time = 2.5f;
};

/// Share of the force that a scene deserves: 1 while messages come, falling to 0 at the silence limit. What
/// a gap took away stays away until messages have come in time for a while, and then comes back slowly:
/// gaps that repeat themselves settle the share at what the longest of them left, so that the force stands
/// still instead of going up and down with them.
class Freshness {
  public:
    explicit Freshness(const SafetySettings& settings) : settings_(settings) {}

    /// `age` [s] since the last message arrived; not-a-number or negative counts as stale.
    float update(float age, float dt);
    [[nodiscard]] float share() const { return share_; }

  private:
    SafetySettings settings_;
    float share_ = 0.0f;
    bool heard_ = false;  // a first message: it gives all, for the engagement's ramp follows
    float calm_ = 0.0f;   // [s] without a gap
};

/// Share of the force that may be exerted at all. At the start, and after a force that was not finite,
/// several quiet cycles in a row must pass, so that nobody is kicked by a device that wakes up inside
/// something (as CHAI3D does); after a device that was too far from the scene's, as many cycles with one
/// that is near, for a hand that is still pressing on something would never be quiet. Then the force ramps
/// up.
class Engagement {
  public:
    explicit Engagement(const SafetySettings& settings) : settings_(settings) {}

    /// `there`: a scene to feel; `force` [N]: what would be exerted in full, a torque by its lever.
    float update(bool there, float force, float dt);
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
