// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/device/coupling.hpp"

namespace eti::devices {

/// How forces engage, and how they end when the scene falls silent.
struct SafetySettings {
    float quiet_force = 0.3f;  ///< [N], a cycle with a smaller force is quiet
    int quiet_cycles = 20;     ///< in a row, before forces engage
    float ramp_time = 0.5f;    ///< [s], from zero to full force
    /// [s]; upper limit of a late cycle's duration wherever force grows: rate limit, ramp, recovery.
    float longest_cycle = 0.002f;
    float longest_pause = 0.025f;  ///< [s] without a cycle; a longer pause restarts the ramp
    /// [s] between messages: during a longer gap, the last message's state is frozen. Two consecutive
    /// messages of 180 Hz may be lost (16.7 ms).
    float gap = 0.017f;
    /// [s] after a gap, during which messages still count as affected by it. A message may have been delayed
    /// by 50 ms, and the proxy takes 30 ms to catch up with the device.
    float settling_time = 0.08f;
    /// [s] without a message after which the force is zero. A larger value keeps forces through a late
    /// server's gaps, at the cost of rendering an old scene for as long.
    float silence_limit = 0.300f;
    /// Share of that limit during which the full force is held; over the rest it fades. Holding beyond 100 ms
    /// does more harm than fading where the patient recedes at 20 mm/s, the fastest that the server moves the
    /// gums. That holds for a wall in a light grip, for gaps of 110 ms and more
    /// (docs/decisions/haptic-forces.md, haptics-gaps.csv).
    float held_share = 1.0f / 3.0f;
    [[nodiscard]] float stale_after() const { return held_share * silence_limit; }
    /// [s], from zero to full, for force that was added in a gap or had faded in it. Slower than a touch at
    /// 50 mm/s (40 N/s at 800 N/m), which is not perceived as a jolt.
    float return_time = 0.25f;
};

/// Share of the force according to the scene's age: 1 while messages arrive, and during a gap no longer than
/// the hold time; then it falls to 0 at the silence limit. ForceRecoveryRamp ramps a returning force up.
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

/// Recovery after a gap. The first message afterwards may report a proxy elsewhere or a new contact, or
/// arrive when the force has faded. Reductions of the force apply at once; additions ramp up over the return
/// time, while the previous contact keeps its full stiffness.
class ForceRecoveryRamp {
  public:
    explicit ForceRecoveryRamp(const SafetySettings& settings) : settings_(settings) {}

    /// `wanted` without the part still to be added. `after_gap`: this cycle is the first with a message after
    /// a gap, and `exerted` is the wrench just before it. Never pulls where `wanted` pushes.
    Wrench update(const Wrench& wanted, const Wrench& exerted, bool after_gap, float dt,
                  const CouplingSettings& coupling);
    void reset() { lacking_ = {}; }
    /// Whether the part still to be added is large enough to be felt and to falsify the energy account.
    [[nodiscard]] bool active() const;

  private:
    SafetySettings settings_;
    Wrench lacking_;
};

/// Share of the force that may be exerted. At the start, and after a non-finite force, several consecutive
/// quiet cycles must pass, so that a device that starts inside an object does not kick (as in CHAI3D). After
/// the device was too far from the scene's, as many cycles near it suffice, since a hand still pressing on
/// something would never be quiet. Then the force ramps up, faster in the second case.
class Engagement {
  public:
    explicit Engagement(const SafetySettings& settings) : settings_(settings) {}

    /// `there`: a scene is available; `force` [N]: the full force, a torque by its lever.
    float update(bool there, float force, float dt);
    void disengage();
    [[nodiscard]] float share() const { return share_; }

  private:
    SafetySettings settings_;
    bool needs_quiet_ = true;
    bool back_ = false;  // force was full before an absence
    int cycles_ = 0;
    float share_ = 0.0f;
};

/// `wanted`, limited to a change from `last` within the force-rate limit times `dt`. The torque's limit
/// follows from it: both reach their range in the same time.
[[nodiscard]] Wrench rate_limited(const Wrench& wanted, const Wrench& last, float dt,
                                  const CouplingSettings& settings);

}  // namespace eti::devices
