// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "devices/haptics/force_renderer.hpp"
#include "tests/validation/haptics/channel.hpp"
#include "tests/validation/haptics/held_device.hpp"

namespace eti::validation {

/// What the hand presses the blade against.
enum class Medium : std::uint8_t {
    wall,    ///< the server's shell; the parameter is the coupling's stiffness
    tissue,  ///< an elastic half-space on the server; the parameter is its rendered stiffness
};

/// How the hand moves the blade there.
enum class Move : std::uint8_t {
    press,  ///< flat, by translating the whole blade
    lever,  ///< by its end, turning it about the grip, on a wall; the parameter is the rotational stiffness
};

struct Grip {
    std::string_view name;
    float stiffness, damping;  ///< [N/m], [N s/m]
    float share;               ///< of HandSettings' rotational stiffness and damping, where the hand levers
};
inline constexpr Grip firm{"firm grip", 900.0f, 18.0f, 1.0f};  ///< as in HandSettings
inline constexpr Grip light{"light grip", 150.0f, 3.0f, 1.0f / 6.0f};

/// A server that stalls from time to time because of other load on the machine.
struct Gaps {
    double shortest = 0.0,
           longest = 0.0;    ///< [s], between consecutive messages, uniformly distributed; 0: none
    double every = 0.0;      ///< [s] of timely messages between two gaps; 0: gaps only
    int in_a_row = 1;        ///< gaps, with a message between them, before messages are timely again
    double from = 0.0;       ///< [s], time of the first gap
    bool caught_up = false;  ///< missed steps are made up for, with the newest pose
};

/// A patient whose surface moves away from the hand along its normal at a constant speed and back,
/// repeatedly; with a negative speed it approaches the hand first.
struct Moving {
    double speed = 0.0;     ///< [m/s]
    double reach = 2.3e-3;  ///< [m], amplitude
    double from = 0.0;      ///< [s], start of the motion
};

struct LoopCase {
    Medium medium = Medium::wall;
    devices::SoftForce law = devices::SoftForce::constraint;
    Move move = Move::press;
    Motors motors = Motors::six;
    float stiffness = CouplingSettings{}.stiffness;  ///< [N/m]; for a lever [N m/rad]
    bool passivity = true;
    Channel channel;
    Gaps gaps;
    Moving patient;
    Grip grip = firm;
    devices::SafetySettings safety;
    std::uint64_t seed = 1;
};

struct LoopOutcome {
    /// [m], peak to peak of the device (of a lever: the blade's end), pressed and held still for a second:
    /// the minimum of five windows, because a limit cycle persists in all of them.
    double excursion = 0.0;
    double dip =
        0.0;  ///< [m], the maximum of those windows: the force is released while messages are missing
    double faded = 0.0;          ///< share of that second with reduced force because messages are missing
    double rendered = 0.0;       ///< [N/m], force over depth between two depths held still; not for a lever
    double onset = 0.0;          ///< [s], from the blade's contact with the surface to a force of 0.05 N
    double energy_lowest = 0.0;  ///< [J], of the passivity observer
    double dissipated = 0.0;     ///< [J], by the passivity controller
    float most_force = 0.0f;     ///< [N]
    float most_torque = 0.0f;    ///< [N m]
};

/// Force on a hand that moves through free air and stops abruptly; the maximum over six phases of the
/// server's step.
struct StopOutcome {
    float moving = 0.0f;   ///< [N], maximum while it moves steadily
    float stopped = 0.0f;  ///< [N], maximum after it has stopped
    bool engaged = true;   ///< forces were on
};

/// A hand that presses on something, per cycle of the observation.
struct HeldHand {
    std::vector<double> height;  ///< [m]
    std::vector<double> force;   ///< [N]
    double whole = 0.0;          ///< share of the time with full force
};

/// Effect of gaps between messages on it.
struct GapOutcome {
    double excursion = 0.0;  ///< [m], maximum deviation from the device's path without gaps
    double away = 0.0;       ///< [m], the same, RMS
    double whole = 0.0;      ///< share of the time with full force
    double rise = 0.0;       ///< [N], maximum growth of the force in 10 ms
    double force = 0.0;      ///< [N], mean
};

/// Ten encoder steps of the simulated device: a limit cycle exceeds this, a hand held still does not.
inline constexpr double most_excursion = 0.3e-3;

/// Peak-to-peak motion of a device held still, in five windows of a fifth of a second.
class Stillness {
  public:
    static constexpr int windows = 5, window_ms = 200, length_ms = windows * window_ms;

    /// `position` [m] along the surface's normal, `at_ms` after the observation began; samples outside of it
    /// are ignored.
    void add(int at_ms, double position);
    /// [m], of the stillest window, because a limit cycle persists in all of them. One metre when nothing was
    /// added.
    [[nodiscard]] double excursion() const;
    /// [m], of the window that moves most.
    [[nodiscard]] double dip() const;

  private:
    struct Window {
        double low = 1.0, high = -1.0;
    };
    std::array<Window, windows> windows_{};
};

/// The haptic loop's own cycle with a simulated device in a hand, and the server's rigid layer or an elastic
/// half-space at 180 Hz behind a channel with delay, jitter and loss. It runs by a virtual clock, exact and
/// repeatable. The hand moves from 5 mm above the surface to 4 mm below it at 50 mm/s, is bumped after two
/// seconds, and holds still; then it moves 2 mm deeper, to measure the stiffness. A lever's blade moves by
/// its end, the same distance and speed.
[[nodiscard]] LoopOutcome run_loop(const LoopCase& loop);

/// The same loop with a device moved through free air at `speed` [m/s] whatever force it gets, and stopped
/// within one cycle, faster than any hand can.
[[nodiscard]] StopOutcome stop_in_free_air(const LoopCase& loop, float speed);

/// The same loop with a hand that keeps the blade pressed 4 mm in. The case's gaps and the patient's motion
/// begin once it is held; observation begins then.
[[nodiscard]] HeldHand hold_on(LoopCase loop);

/// Effect of gaps on the first hand, relative to the second, which had none.
[[nodiscard]] GapOutcome compare(const HeldHand& with_gaps, const HeldHand& without);

/// Largest stiffness up to which no limit cycle shows, to 15 %, in steps by 1.42 from 50 to 20,000 N/m, for a
/// lever from 0.1 to 20 N m/rad; 0 if the lowest shows one.
[[nodiscard]] double largest_stable_stiffness(LoopCase loop);

}  // namespace eti::validation
