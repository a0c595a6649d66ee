// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/threads/processor_share.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <fstream>
#include <string>
#include <string_view>

#include "common/process/threads/processors.hpp"

namespace eti {

namespace {

constexpr std::string_view prefix = "neoeti/simulation/";

/// Whether both may run on one processor. A process that cannot be looked at, as one in another PID
/// namespace, may.
bool compete(const cpu_set_t& own, pid_t other) {
    cpu_set_t theirs, both;
    if (::sched_getaffinity(other, sizeof theirs, &theirs) != 0) {
        return true;
    }
    CPU_AND(&both, &own, &theirs);
    return CPU_COUNT(&both) > 0;
}

}  // namespace

ProcessorShare::ProcessorShare() : announcement_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const std::string name = fmt::format("{}{}", prefix, ::getpid());
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    // An abstract name begins with a zero.
    std::ranges::copy(name, address.sun_path + 1);
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
    if (announcement_ &&
        ::bind(announcement_.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0) {
        announcement_ = {};
    }
}

unsigned ProcessorShare::simulations() {
    cpu_set_t own;
    const bool known = ::sched_getaffinity(0, sizeof own, &own) == 0;
    unsigned others = 0;
    std::ifstream sockets("/proc/net/unix");
    for (std::string line; std::getline(sockets, line);) {
        // Abstract names follow a '@', as the last column (proc(5)).
        const std::size_t at = line.find('@');
        if (at == std::string::npos || line.compare(at + 1, prefix.size(), prefix) != 0) {
            continue;
        }
        const char* const first = line.data() + at + 1 + prefix.size();
        pid_t pid = 0;
        const auto [rest, error] = std::from_chars(first, line.data() + line.size(), pid);
        const bool whole = error == std::errc() && rest == line.data() + line.size();
        others += whole && pid != ::getpid() && (!known || compete(own, pid)) ? 1 : 0;
    }
    return 1 + others;
}

unsigned ProcessorShare::processors() {
    return std::max(1u, usable_processors() / simulations());
}

}  // namespace eti
