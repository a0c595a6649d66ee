// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "common/device/hand.hpp"
#include "devices/haptics/force_renderer.hpp"

namespace eti::validation {

/// What the hand presses the blade on.
enum class Medium : std::uint8_t {
    wall,    ///< the server's shell; what is set is the coupling's stiffness
    tissue,  ///< an elastic half-space of the server; what is set is its stiffness as rendered
};

/// How the hand brings the blade there.
enum class Move : std::uint8_t {
    press,  ///< flat, by moving the whole blade
    lever,  ///< by its end, turning it about the grip, on a wall; what is set is the stiffness in turning
};

/// What the device can pull with.
enum class Motors : std::uint8_t {
    six,    ///< force and torque
    three,  ///< a force at its gimbal, 60 mm up the handle, in whose joints the tool turns freely
};

/// The way between device and server; half of the delay each way.
struct Channel {
    double delay = 0.0;   ///< [s], there and back
    double jitter = 0.0;  ///< [s], most that a message is later than its delay, each way, evenly distributed
    double loss = 0.0;    ///< share of messages, each way
};

struct Grip {
    std::string_view name;
    float stiffness, damping;  ///< [N/m], [N s/m]
    float share;               ///< of HandSettings' stiffness and damping in turning, where the hand levers
};
inline constexpr Grip firm{"firm grip", 900.0f, 18.0f, 1.0f};  ///< as in HandSettings
inline constexpr Grip light{"light grip", 150.0f, 3.0f, 1.0f / 6.0f};

/// A server that now and then computes nothing for a while, beside a machine's other work.
struct Gaps {
    double shortest = 0.0, longest = 0.0;  ///< [s], from one message to the next, evenly distributed; 0: none
    double every = 0.0;                    ///< [s] of messages in time between two gaps; 0: gaps only
    int in_a_row = 1;        ///< gaps, with a message between them, before messages come in time again
    double from = 0.0;       ///< [s], before which there are none
    bool caught_up = false;  ///< the steps that were missed are made up for, with the newest pose
};

/// A patient whose surface goes away from the hand along its normal at a constant speed, and comes back, and
/// so on; at a negative speed it comes towards the hand first.
struct Moving {
    double speed = 0.0;     ///< [m/s]
    double reach = 2.3e-3;  ///< [m], to either side
    double from = 0.0;      ///< [s], before which it rests
};

struct LoopCase {
    Medium medium = Medium::wall;
    devices::SoftForce law = devices::SoftForce::constraint;
    Move move = Move::press;
    Motors motors = Motors::six;
    float stiffness = CouplingSettings{}.stiffness;  ///< [N/m]; of a lever [N m/rad]
    bool passivity = true;
    Channel channel;
    Gaps gaps;
    Moving patient;
    Grip grip = firm;
    devices::SafetySettings safety;
    std::uint64_t seed = 1;
};

struct LoopOutcome {
    /// [m], peak to peak of the device (levered: of the blade's end), pressed and held still for a second:
    /// the least of five windows, for a limit cycle goes on and on.
    double excursion = 0.0;
    double dip = 0.0;       ///< [m], the most of those windows: where messages are missing, the force lets go
    double faded = 0.0;     ///< share of that second with less than all force for want of messages
    double rendered = 0.0;  ///< [N/m], force over depth between two depths held still; of a lever nothing
    double onset = 0.0;     ///< [s], from the blade's reaching the surface to a force of 0.05 N
    double energy_lowest = 0.0;  ///< [J], the observer's
    double dissipated = 0.0;     ///< [J], by the controller
    float most_force = 0.0f;     ///< [N]
    float most_torque = 0.0f;    ///< [N m]
};

/// What a hand feels that moves through free air and stops at once; the most of six phases of the server's
/// step.
struct StopOutcome {
    float moving = 0.0f;   ///< [N], most while it moves steadily
    float stopped = 0.0f;  ///< [N], most after it has stopped
    bool engaged = true;   ///< forces were on
};

/// A hand that presses on something, cycle by cycle of the watch.
struct HeldHand {
    std::vector<double> height;  ///< [m]
    std::vector<double> force;   ///< [N]
    double whole = 0.0;          ///< share of the time with all of the force
};

/// What gaps between messages do to it.
struct GapOutcome {
    double excursion = 0.0;  ///< [m], most that the device is away from where it would be without gaps
    double away = 0.0;       ///< [m], the same, root mean square
    double whole = 0.0;      ///< share of the time with all of the force
    double rise = 0.0;       ///< [N], most that the force grows by in 10 ms
    double force = 0.0;      ///< [N], mean
};

/// Ten encoder steps of the simulated device: what a limit cycle exceeds, and a hand held still does not.
inline constexpr double most_excursion = 0.3e-3;

/// How still a device is that a hand holds still: peak to peak in five windows of a fifth of a second.
class Stillness {
  public:
    static constexpr int windows = 5, window_ms = 200, length_ms = windows * window_ms;

    /// `position` [m] along the surface's normal, `at_ms` after the watch began; others are left out.
    void add(int at_ms, double position);
    /// [m], of the stillest window: a limit cycle goes on and on. A metre when nothing was added.
    [[nodiscard]] double excursion() const;
    /// [m], of the least still one.
    [[nodiscard]] double dip() const;

  private:
    struct Window {
        double low = 1.0, high = -1.0;
    };
    std::array<Window, windows> windows_{};
};

/// The haptic loop's own cycle with a simulated device in a hand, and the server's rigid layer or an
/// elastic half-space at 180 Hz behind a channel with delay, jitter and loss; by a virtual clock, so that
/// it is exact and repeatable. The hand goes from 5 mm above the surface to 4 mm below it at 50 mm/s, is
/// bumped after two seconds, and holds still; then it goes 2 mm deeper, for the stiffness. A lever's blade
/// goes by its end, as far and as fast.
[[nodiscard]] LoopOutcome run_loop(const LoopCase& loop);

/// The same loop with a device that is carried through free air at `speed` [m/s] whatever it feels, and
/// stopped from one cycle to the next, which no hand can do faster.
[[nodiscard]] StopOutcome stop_in_free_air(const LoopCase& loop, float speed);

/// The same loop with a hand that holds the blade pressed 4 mm in and on. The case's gaps and the patient's
/// motion begin when it is held, and then it is watched.
[[nodiscard]] HeldHand hold_on(LoopCase loop);

/// What gaps did to the first hand, by the second, which had none.
[[nodiscard]] GapOutcome compare(const HeldHand& with_gaps, const HeldHand& without);

/// Largest stiffness up to which no limit cycle shows, to 15 %, in steps by 1.42 from 50 to 20,000 N/m, of a
/// lever from 0.1 to 20 N m/rad; 0 if the lowest shows one.
[[nodiscard]] double largest_stable_stiffness(LoopCase loop);

}  // namespace eti::validation
