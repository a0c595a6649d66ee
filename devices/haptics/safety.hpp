// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/device/coupling.hpp"

namespace eti::devices {

/// When forces begin, and how they end when the scene falls silent.
struct SafetySettings {
    float quiet_force = 0.3f;  ///< [N], a cycle that would exert less is quiet
    int quiet_cycles = 20;     ///< in a row, before forces engage
    float ramp_time = 0.5f;    ///< [s], from no force to all of it
    /// [s]; a later cycle counts for no more where force grows: in its rate, its ramp, its coming back.
    float longest_cycle = 0.002f;
    float longest_pause = 0.025f;  ///< [s] without a cycle; after more, force begins anew by the ramp
    /// [s] from one message to the next: a longer gap is bridged by what the last one told, standing still.
    /// Two messages of 180 Hz in a row may be lost (16.7 ms).
    float gap = 0.017f;
    /// [s] after a gap, in which messages still tell of it: one may have been under way for 50 ms, and the
    /// proxy takes 30 ms to come to where the device has gone meanwhile.
    float settling_time = 0.08f;
    /// [s] without a message, by which there is no force; larger keeps forces through a late server's gaps,
    /// at the cost of feeling an old scene for as long.
    float silence_limit = 0.300f;
    /// Of that limit, through which the force is held whole; over the rest it fades. After 100 ms, holding
    /// does more harm than letting go, where the patient moves off at 20 mm/s, as fast as the server lets the
    /// gums go: from gaps of 110 ms on, of a wall in a light grip (docs/decisions/haptic-forces.md,
    /// haptics-gaps.csv).
    float held_share = 1.0f / 3.0f;
    [[nodiscard]] float stale_after() const { return held_share * silence_limit; }
    /// [s], from no force to all of it, of what came to the force in a gap or had faded in it; slower than a
    /// touch at 50 mm/s (40 N/s at 800 N/m), which nobody calls a jolt.
    float return_time = 0.25f;
};

/// Share of the force that a scene deserves: 1 while messages come and while they are missing for no longer
/// than the scene may be held, falling to 0 at the silence limit. What comes back is Regrowth's to ramp up.
class Freshness {
  public:
    explicit Freshness(const SafetySettings& settings) : settings_(settings) {}

    /// `age` [s] since the last message arrived; NaN or negative counts as stale.
    float update(float age);
    [[nodiscard]] float share() const { return share_; }

  private:
    SafetySettings settings_;
    float share_ = 0.0f;
};

/// The way back after a gap. The first message after one may tell of a proxy elsewhere, of a contact that
/// nobody knew of, or come when the force had faded. What it takes away from the force goes at once; what it
/// adds comes in over the return time, while the hand feels all of the stiffness of what was there before.
class Regrowth {
  public:
    explicit Regrowth(const SafetySettings& settings) : settings_(settings) {}

    /// `wanted` without what is still to come. `after_gap`: this cycle is the first with a message that
    /// tells of a gap, `exerted` is what the hand had just before it. Never pulls where `wanted` pushes.
    Wrench update(const Wrench& wanted, const Wrench& exerted, bool after_gap, float dt,
                  const CouplingSettings& coupling);
    void forget() { lacking_ = {}; }
    /// So much is still to come that a hand would tell, and the account of energy would be wrong about it.
    [[nodiscard]] bool growing() const;

  private:
    SafetySettings settings_;
    Wrench lacking_;
};

/// Share of the force that may be exerted at all. At the start, and after a force that was not finite,
/// several quiet cycles in a row must pass, so that nobody is kicked by a device that wakes up inside
/// something (as CHAI3D does); after a device that was too far from the scene's, as many cycles with one
/// that is near, for a hand that is still pressing on something would never be quiet. Then the force ramps
/// up, and the second way faster.
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
    bool back_ = false;  // force was whole before, and only away
    int cycles_ = 0;
    float share_ = 0.0f;
};

/// `wanted`, but no farther from `last` than the force-rate limit allows in `dt`. The torque's limit
/// follows from it: both reach their range in the same time.
[[nodiscard]] Wrench rate_limited(const Wrench& wanted, const Wrench& last, float dt,
                                  const CouplingSettings& settings);

}  // namespace eti::devices
