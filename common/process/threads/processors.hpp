// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace eti {

/// Number of processors that this process may keep busy: those that its affinity allows (sched_setaffinity,
/// cpusets), and no more than the processor time that its control groups grant (a container's quota), rounded
/// down. At least one.
[[nodiscard]] unsigned usable_processors();

/// Processor time per time that control groups of version 2 (cpu.max) and 1 (cpu.cfs_quota_us) grant: the
/// smallest quota from the group up to the root. Nullopt without any. `groups`: contents of
/// /proc/self/cgroup; `mounts`: the folder of the mounted hierarchies, normally /sys/fs/cgroup.
[[nodiscard]] std::optional<double> processor_quota(const std::string& groups,
                                                    const std::filesystem::path& mounts);

}  // namespace eti
