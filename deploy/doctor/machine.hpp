// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "common/bus/bus.hpp"
#include "deploy/doctor/finding.hpp"

namespace eti::doctor {

struct SharedMemory {
    bool there = false;
    std::uint64_t size = 0;  ///< [bytes]
    std::uint64_t free = 0;  ///< [bytes]
    std::size_t stale = 0;   ///< files of dead processes
    bool used = false;       ///< this session's profile may use it
};

[[nodiscard]] SharedMemory shared_memory(const std::filesystem::path& folder, bool used);
[[nodiscard]] Findings diagnose_shared_memory(const SharedMemory& memory);

/// Whether a thread of this process may have the bus's priorities.
[[nodiscard]] Findings real_time_rights();

/// Versions of this program and of the DDS library.
[[nodiscard]] Findings versions();

/// The identity's files, one finding per fault.
[[nodiscard]] Findings identity(const bus::Options& options);

}  // namespace eti::doctor
