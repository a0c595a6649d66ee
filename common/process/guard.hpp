// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace eti {

/// Result of a task in a child process.
struct GuardedResult {
    int status = 0;                     ///< the task's result, if it completed
    std::optional<std::string> broken;  ///< why it did not complete, e.g. "signal 11 (Segmentation fault)"
    bool stopped = false;               ///< it was ended because this process was asked to end
};

/// GuardedResult::status of a task that was stopped; as a shell reports Ctrl-C.
inline constexpr int status_stopped = 130;

struct GuardLimits {
    unsigned processor_seconds = 120;
    std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< of address space
};

/// For a task that changes nothing and does not poll stop_requested().
void end_at_once_on_stop();

/// Runs `task` in a child process with bounded memory and processor time and without a core file. A damaged
/// or hostile file can crash or hang the library that reads it; in a child, only the child is affected. The
/// child shares standard output and error. When this process is asked to end (stop_requested()), the child
/// gets SIGTERM: it ends by itself where the task polls, at once after end_at_once_on_stop(). Call it while
/// no other thread holds a lock that the task needs.
[[nodiscard]] GuardedResult run_guarded(const std::function<int()>& task, const GuardLimits& limits = {});

}  // namespace eti
