// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace eti::session {

/// What became of a task that ran in a child process.
struct Guarded {
    int status = 0;                     ///< the task's result, when it came to its end
    std::optional<std::string> broken;  ///< why it did not, e.g. "signal 11 (Segmentation fault)"
};

/// Runs `task` in a child process with bounded memory (4 GiB), processor time and no core file. A
/// damaged or hostile file can crash or hang the HDF5 library; there it does so for itself alone.
/// The child shares standard output and error. Call it while the program has no other thread.
[[nodiscard]] Guarded run_guarded(const std::function<int()>& task, unsigned processor_seconds = 120);

}  // namespace eti::session
