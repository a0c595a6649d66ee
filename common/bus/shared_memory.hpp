// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace eti::bus {

/// Shared-memory files of the DDS library whose owner is dead.
struct StaleSharedMemory {
    std::vector<std::string> transport;     ///< fastrtps_* or fastdds_*, removed by `fastdds shm clean`
    std::vector<std::string> data_sharing;  ///< fast_datasharing_*, which that command does not remove
};

/// Searches `folder`. A transport file is in use while its lock file is locked, a data-sharing file while a
/// process maps it. Unreadable files (another user's) count as in use.
[[nodiscard]] StaleSharedMemory find_stale_shared_memory(const std::filesystem::path& folder = "/dev/shm");

}  // namespace eti::bus
