// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>

namespace eti {

/// Real-time priorities (SCHED_FIFO) of the threads between a hand and what it feels. What runs for
/// microseconds goes before what runs for milliseconds: the other way round it would be late every time,
/// and this way it costs the longer work next to nothing.
namespace priority {
inline constexpr int loop = 80;    ///< the haptic loop; below the kernel's own
inline constexpr int bus = 70;     ///< takes messages in, and sends what is felt
inline constexpr int step = 60;    ///< the simulation, and what shares the bus's locks with the above
inline constexpr int beside = 50;  ///< what a step may have to wait for
}  // namespace priority

/// Gives the calling thread a real-time priority; the threads that it starts have none. Returns an empty
/// text, or why the kernel refused and what to do.
[[nodiscard]] std::string become_real_time(int priority);

/// Back to an ordinary one.
void become_ordinary();

/// While this lives, the calling thread has a real-time priority and so have the threads that it starts: for
/// those of a library, which cannot be asked. Afterwards the calling thread has an ordinary one.
class RealTimeThreads {
  public:
    /// Not `wanted`: does nothing.
    explicit RealTimeThreads(int priority, bool wanted = true);
    ~RealTimeThreads();
    RealTimeThreads(const RealTimeThreads&) = delete;
    RealTimeThreads& operator=(const RealTimeThreads&) = delete;
    /// Empty, or why the kernel refused and what to do.
    [[nodiscard]] const std::string& refusal() const { return refusal_; }

  private:
    bool wanted_;
    std::string refusal_;
};

/// Lets others go before the calling thread and those that it starts later, by a nice value up to 19. Needs
/// no rights. The kernel may share among sessions of processes first (autogroups), and then it counts in
/// each.
void yield_to_others(int nice);

}  // namespace eti
