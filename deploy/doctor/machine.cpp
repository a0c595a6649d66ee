// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "deploy/doctor/machine.hpp"

#include <fmt/format.h>
#include <sys/statvfs.h>

#include <ctime>
#include <thread>

#include "common/bus/library_log.hpp"
#include "common/bus/security/identity_check.hpp"
#include "common/bus/shared_memory.hpp"
#include "common/process/threads/priority.hpp"

namespace eti::doctor {

namespace {

// A segment of 8 MB per program and its ports, for six programs.
constexpr std::uint64_t enough_shared_memory = 64u << 20;  // [bytes]

/// Parses "FILE: problem; remedy" as the check writes it.
Finding fault(const std::string& line, State state) {
    const std::size_t at = line.find("; ");
    return {"security", "identity", state, line.substr(0, at),
            at == std::string::npos ? "" : line.substr(at + 2)};
}

}  // namespace

SharedMemory shared_memory(const std::filesystem::path& folder, bool used) {
    SharedMemory memory;
    memory.used = used;
    struct statvfs state {};
    if (::statvfs(folder.c_str(), &state) != 0) {
        return memory;
    }
    memory.there = true;
    memory.size = std::uint64_t{state.f_blocks} * state.f_frsize;
    memory.free = std::uint64_t{state.f_bavail} * state.f_frsize;
    const bus::StaleSharedMemory stale = bus::find_stale_shared_memory(folder);
    memory.stale = stale.transport.size() + stale.data_sharing.size();
    return memory;
}

Findings diagnose_shared_memory(const SharedMemory& memory) {
    // Only a custom profile uses shared memory; the programs' own transport is UDP.
    const State serious = memory.used ? State::problem : State::info;
    if (!memory.there) {
        return {{"memory", "/dev/shm", serious, "is missing",
                 "only a --profile with shared memory needs it; mount a tmpfs there, or leave that transport "
                 "out"}};
    }
    Findings findings{{"memory", "/dev/shm", State::ok,
                       fmt::format("{} MB, {} MB free", memory.size >> 20, memory.free >> 20), ""}};
    if (memory.free < enough_shared_memory) {
        findings.front().state = serious;
        findings.front().remedy = fmt::format(
            "a --profile with shared memory needs {} MB: enlarge it (mount -o remount,size=256m /dev/shm; in "
            "a container --shm-size 256m), or free some",
            enough_shared_memory >> 20);
    }
    if (memory.stale > 0) {
        findings.push_back({"memory", "stale files", State::info,
                            fmt::format("{} files of dead processes in shared memory", memory.stale),
                            "remove them: fastdds shm clean; what remains of fast_datasharing_*: rm"});
    }
    return findings;
}

Findings real_time_rights() {
    std::string refusal;
    std::thread([&] { refusal = set_real_time_priority(priority::loop); }).join();
    if (refusal.empty()) {
        return {
            {"rights", "real time", State::ok, fmt::format("priority {} is granted", priority::loop), ""}};
    }
    return {{"rights", "real time", State::problem, refusal.substr(0, refusal.find(": ")),
             fmt::format("forces may be late under load; put '@haptics - rtprio {}' into "
                         "/etc/security/limits.d/neoeti.conf and log in again (docs/install.md)",
                         priority::loop)}};
}

Findings versions() {
    return {{"versions", "NeoETI", State::ok, fmt::format("{}, protocol {}", ETI_VERSION, bus::protocol), ""},
            {"versions", "Fast DDS", State::ok, bus::library_version(), ""}};
}

Findings identity(const bus::Options& options) {
    if (options.identity.empty()) {
        return {{"security", "identity", State::ok,
                 "none requested: anyone who can reach this session may join it", ""}};
    }
    const bus::IdentityCheck check =
        bus::check_identity(options.identity, options.session, options.domain, std::time(nullptr));
    Findings findings;
    for (const std::string& line : check.faults) {
        findings.push_back(fault(line, State::problem));
    }
    for (const std::string& line : check.warnings) {
        findings.push_back(fault(line, State::info));
    }
    if (check.faults.empty()) {
        findings.push_back({"security", "identity", State::ok,
                            fmt::format("'{}' ({}) of '{}', valid until {} UTC", check.name, check.role,
                                        check.authority, bus::date_text(check.until)),
                            ""});
    }
    return findings;
}

}  // namespace eti::doctor
