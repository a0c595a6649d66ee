// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace eti::bus {

/// Files of the DDS library's shared memory whose owner is gone.
struct StaleSharedMemory {
    std::vector<std::string> transport;     ///< fastrtps_*, removed by `fastdds shm clean`
    std::vector<std::string> data_sharing;  ///< fast_datasharing_*, which that command leaves behind
};

/// Looks in `folder`. A transport file is in use while its lock file is locked; a data-sharing file
/// while a process maps it. What cannot be read (another user's) counts as in use.
[[nodiscard]] StaleSharedMemory find_stale_shared_memory(const std::filesystem::path& folder = "/dev/shm");

}  // namespace eti::bus
