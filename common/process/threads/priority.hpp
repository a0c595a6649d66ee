// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>

namespace eti {

/// Real-time priorities (SCHED_FIFO) of the threads in the haptic path. Work of microseconds precedes work of
/// milliseconds: the reverse order would delay it every time, while this order hardly delays the longer work.
namespace priority {
inline constexpr int loop = 80;        ///< the haptic loop; below the kernel's own
inline constexpr int bus = 70;         ///< receives messages and sends forces
inline constexpr int step = 60;        ///< the simulation; shares the bus's locks with the above
inline constexpr int background = 50;  ///< work that a step may have to wait for
}  // namespace priority

/// Sets a real-time priority for the calling thread, but not for the threads that it starts. Returns an empty
/// text, or why the kernel refused and the remedy.
[[nodiscard]] std::string set_real_time_priority(int priority);

/// A thread as the kernel numbers it, gettid(2).
using ThreadId = int;
[[nodiscard]] ThreadId this_thread_id();

/// Normal scheduling, as a value for set_thread_priority().
inline constexpr int ordinary_priority = 0;

/// Sets another thread's real-time priority, or normal scheduling. False if the kernel refuses, or if there
/// is no such thread any more.
bool set_thread_priority(ThreadId thread, int priority);

/// Restores normal scheduling.
void reset_priority();

/// During its lifetime, the calling thread and the threads that it starts have a real-time priority: for a
/// library's threads, which cannot be configured. The destructor restores the calling thread's normal
/// scheduling.
class RealTimeThreads {
  public:
    /// With `wanted` false: does nothing.
    explicit RealTimeThreads(int priority, bool wanted = true);
    ~RealTimeThreads();
    RealTimeThreads(const RealTimeThreads&) = delete;
    RealTimeThreads& operator=(const RealTimeThreads&) = delete;
    /// Empty, or why the kernel refused and the remedy.
    [[nodiscard]] const std::string& refusal() const { return refusal_; }

  private:
    bool wanted_;
    std::string refusal_;
};

/// Lowers the priority of the calling thread, and of threads that it starts later, by a nice value up to 19.
/// Needs no privileges. With autogroups, the kernel first divides time among process sessions, and the value
/// counts within each.
void lower_priority(int nice);

}  // namespace eti
