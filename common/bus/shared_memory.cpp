// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/shared_memory.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <fstream>
#include <set>

#include "common/process/files/descriptor.hpp"

namespace eti::bus {

namespace fs = std::filesystem;

namespace {

bool lock_is_free(const fs::path& file) {
    const Descriptor lock(::open(file.c_str(), O_RDWR | O_CLOEXEC));
    return lock && ::flock(lock.get(), LOCK_EX | LOCK_NB) == 0;
}

/// Of either major version of the library, as programs of both can run on a machine.
bool is_transport_lock(const std::string& name) {
    return (name.starts_with("fastrtps_") || name.starts_with("fastdds_")) &&
           (name.ends_with("_el") || name.ends_with("_sl"));
}

struct Mappings {
    std::set<std::string> files;  ///< files of the folder that some process maps
    std::set<uid_t> unreadable;   ///< users with a process whose mappings cannot be read
};

Mappings mappings_of(const fs::path& folder) {
    Mappings found;
    std::error_code error;
    const std::string prefix = folder.string() + "/";
    for (const auto& process : fs::directory_iterator("/proc", error)) {
        const std::string pid = process.path().filename().string();
        // Process 1 may hide its mappings even from root, and maps none of our files.
        if (pid == "1" || pid.find_first_not_of("0123456789") != std::string::npos) {
            continue;
        }
        struct stat owner {};
        if (::stat(process.path().c_str(), &owner) != 0) {
            continue;
        }
        std::ifstream maps(process.path() / "maps");
        if (!maps && fs::exists(process.path(), error)) {
            found.unreadable.insert(owner.st_uid);
        }
        for (std::string line; std::getline(maps, line);) {
            if (const auto at = line.find(prefix); at != std::string::npos) {
                found.files.insert(line.substr(at + prefix.size()));
            }
        }
    }
    return found;
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
        } else if (is_transport_lock(name) && lock_is_free(entry.path())) {
            stale.transport.push_back(name.substr(0, name.size() - 3));
        }
    }
    if (!shared.empty()) {
        const Mappings mappings = mappings_of(folder);
        for (const std::string& name : shared) {
            struct stat owner {};
            if (::stat((folder / name).c_str(), &owner) == 0 && !mappings.files.contains(name) &&
                !mappings.unreadable.contains(owner.st_uid)) {
                stale.data_sharing.push_back(name);
            }
        }
    }
    return stale;
}

}  // namespace eti::bus
