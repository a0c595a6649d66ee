// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace eti {

/// What became of a task that ran in a child process.
struct Guarded {
    int status = 0;                     ///< the task's result, when it came to its end
    std::optional<std::string> broken;  ///< why it did not, e.g. "signal 11 (Segmentation fault)"
};

struct GuardLimits {
    unsigned processor_seconds = 120;
    std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< of address space
};

/// Runs `task` in a child process with bounded memory, processor time and no core file. A damaged or
/// hostile file can crash or hang the library that reads it; there it does so for itself alone. The
/// child shares standard output and error. Call it while the program has no other thread that holds
/// a lock the task needs.
[[nodiscard]] Guarded run_guarded(const std::function<int()>& task, const GuardLimits& limits = {});

}  // namespace eti
