// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/shared_memory.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <fstream>
#include <set>

namespace eti::bus {

namespace fs = std::filesystem;

namespace {

bool lock_is_free(const fs::path& file) {
    const int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
    if (descriptor < 0) {
        return false;
    }
    const bool is_free = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
    ::close(descriptor);
    return is_free;
}

/// Of the files in `folder`, those that some process maps. `complete`: every process could be read.
std::set<std::string> mapped_files(const fs::path& folder, bool& complete) {
    std::set<std::string> mapped;
    complete = true;
    std::error_code error;
    const std::string prefix = folder.string() + "/";
    for (const auto& process : fs::directory_iterator("/proc", error)) {
        const std::string pid = process.path().filename().string();
        if (pid.find_first_not_of("0123456789") != std::string::npos) {
            continue;
        }
        std::ifstream maps(process.path() / "maps");
        if (!maps && fs::exists(process.path(), error)) {
            complete = false;
        }
        for (std::string line; std::getline(maps, line);) {
            if (const auto at = line.find(prefix); at != std::string::npos) {
                mapped.insert(line.substr(at + prefix.size()));
            }
        }
    }
    return mapped;
}

}  // namespace

StaleSharedMemory find_stale_shared_memory(const fs::path& folder) {
    StaleSharedMemory stale;
    std::vector<std::string> shared;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with("fast_datasharing_")) {
            shared.push_back(name);
        } else if (name.starts_with("fastrtps_") && (name.ends_with("_el") || name.ends_with("_sl")) &&
                   lock_is_free(entry.path())) {
            stale.transport.push_back(name.substr(0, name.size() - 3));
        }
    }
    if (!shared.empty()) {
        bool complete = false;
        const auto mapped = mapped_files(folder, complete);
        for (const std::string& name : shared) {
            if (complete && !mapped.contains(name)) {
                stale.data_sharing.push_back(name);
            }
        }
    }
    return stale;
}

}  // namespace eti::bus
