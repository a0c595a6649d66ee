// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/threads/processors.hpp"

#include <sched.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>
#include <vector>

namespace eti {

namespace {

std::optional<double> ratio(double quota, double period) {
    return quota > 0.0 && period > 0.0 ? std::optional(quota / period) : std::nullopt;
}

/// "MAX PERIOD" of version 2, where MAX may be the word "max".
std::optional<double> quota_of_v2(const std::filesystem::path& group) {
    double quota = 0.0, period = 0.0;
    std::ifstream file(group / "cpu.max");
    return file >> quota >> period ? ratio(quota, period) : std::nullopt;
}

/// Two files of version 1; a quota of -1 is none.
std::optional<double> quota_of_v1(const std::filesystem::path& group) {
    double quota = 0.0, period = 0.0;
    std::ifstream quota_file(group / "cpu.cfs_quota_us"), period_file(group / "cpu.cfs_period_us");
    return quota_file >> quota && period_file >> period ? ratio(quota, period) : std::nullopt;
}

/// The smallest quota from a group up to the root of its hierarchy. In a container, the group's path may be
/// that of the host, which is not visible; its root then is the container's own group.
template <class QuotaOf>
void note_smallest(const std::filesystem::path& mount, const std::string& group, const QuotaOf& quota_of,
                   std::optional<double>& smallest) {
    std::filesystem::path folder = mount;
    const auto look = [&] {
        if (const auto quota = quota_of(folder); quota && quota < smallest.value_or(*quota + 1.0)) {
            smallest = quota;
        }
    };
    look();
    for (const auto& part : std::filesystem::path(group).relative_path()) {
        folder /= part;
        look();
    }
}

}  // namespace

std::optional<double> processor_quota(const std::string& groups, const std::filesystem::path& mounts) {
    std::optional<double> smallest;
    std::istringstream lines(groups);
    for (std::string line; std::getline(lines, line);) {
        // NUMBER:CONTROLLERS:PATH; version 2 has no controllers.
        const std::size_t first = line.find(':'), second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) {
            continue;
        }
        const std::string controllers = line.substr(first + 1, second - first - 1);
        const std::string group = line.substr(second + 1);
        if (controllers.empty()) {
            note_smallest(mounts, group, quota_of_v2, smallest);
            // Where both versions are mounted.
            note_smallest(mounts / "unified", group, quota_of_v2, smallest);
        } else if (("," + controllers + ",").find(",cpu,") != std::string::npos) {
            for (const std::string& name : {controllers, std::string("cpu")}) {
                note_smallest(mounts / name, group, quota_of_v1, smallest);
            }
        }
    }
    return smallest;
}

unsigned usable_processors() {
    unsigned count = std::max(1u, std::thread::hardware_concurrency());
    cpu_set_t allowed;
    if (::sched_getaffinity(0, sizeof allowed, &allowed) == 0) {
        count = std::max(1u, static_cast<unsigned>(CPU_COUNT(&allowed)));
    }
    std::ifstream file("/proc/self/cgroup");
    const std::string groups{std::istreambuf_iterator<char>(file), {}};
    if (const auto quota = processor_quota(groups, "/sys/fs/cgroup")) {
        count = std::min(count, std::max(1u, static_cast<unsigned>(*quota)));
    }
    return count;
}

}  // namespace eti
