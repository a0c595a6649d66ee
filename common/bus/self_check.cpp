// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <thread>

#include "common/bus/participant.hpp"
#include "common/bus/shared_memory.hpp"
#include "common/bus/transport.hpp"

namespace eti::bus {

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds poll_interval{20};

[[noreturn]] void refuse(const Options& options, const std::string& owner) {
    throw BusError(
        fmt::format("session '{}' on domain {} is already run by server {}: choose another --session, or "
                    "stop that server",
                    options.session, options.domain, owner));
}

/// Throws when another server owns the session, or started on it before this one. A writer of the status that
/// does not identify itself as a server is ignored.
void refuse_second_server(const Participant& self) {
    for (const Peer& peer : self.peers()) {
        // Two servers that start together have both not published yet: the one that started first stays.
        if (peer.name == self.options.name && peer.session == self.options.session &&
            (peer.serves || peer.started < self.started())) {
            refuse(self.options, peer.process);
        }
    }
}

/// A server joins the bus before it builds its patient, and publishes SessionStatus only afterwards.
bool server_is_starting(const Participant& self) {
    return std::ranges::any_of(self.peers(), [&](const Peer& peer) {
        return peer.name == server_name && peer.session == self.options.session;
    });
}

void look_for_server(const Participant& self, bool found, SelfCheck& check) {
    if (found) {
        return;
    }
    std::string elsewhere;
    for (const Peer& peer : self.peers()) {
        if (peer.session != self.options.session &&
            elsewhere.find("'" + peer.session + "'") == std::string::npos) {
            elsewhere += (elsewhere.empty() ? "'" : ", '") + peer.session + "'";
        }
    }
    if (!elsewhere.empty()) {
        check.warnings.push_back(
            fmt::format("no server in session '{}' on domain {}, but there is session {}; is that the "
                        "intended --session?",
                        self.options.session, self.options.domain, elsewhere));
    } else {
        check.warnings.push_back(missing_server_message(self.options));
    }
}

void look_for_stale_memory(SelfCheck& check) {
    const StaleSharedMemory stale = find_stale_shared_memory();
    if (!stale.transport.empty()) {
        check.warnings.push_back(fmt::format(
            "{} shared-memory files of dead processes in /dev/shm; remove them with: fastdds shm clean",
            stale.transport.size()));
    }
    if (!stale.data_sharing.empty()) {
        std::string names;
        for (const std::string& name : stale.data_sharing) {
            names += " /dev/shm/" + name;
        }
        check.warnings.push_back(
            fmt::format("{} data-sharing files of dead processes in /dev/shm, which 'fastdds shm clean' "
                        "leaves; remove them with: rm{}",
                        stale.data_sharing.size(), names));
    }
}

}  // namespace

DiscoveryTimeout explain_missing_server(const Options& options) {
    const bool alone = this_machine_only(options);
    return {fmt::format("no server found in session '{}' on domain {} ({})", options.session, options.domain,
                        reach(options)),
            fmt::format("start eti-server with the same --session and --domain; {}--network, --peer ADDRESS, "
                        "--discovery-server HOST or --profile FILE (docs/network.md){}",
                        alone ? "for a server on another machine, give both programs "
                              : "for other connections, give both programs another of ",
                        options.identity.empty()
                            ? "; for a secured session, --identity DIR (docs/security.md)"
                            : "; both need an --identity of the same lab (docs/security.md)")};
}

std::string missing_server_message(const Options& options) {
    const auto [finding, remedy] = explain_missing_server(options);
    return fmt::format("{}: {}; eti-doctor diagnoses the cause", finding, remedy);
}

void refuse_other_protocol(const Node& node) {
    const Participant& self = *node.impl().participant;
    for (const Peer& peer : self.peers()) {
        if (peer.name == server_name && peer.session == self.options.session && peer.protocol != protocol) {
            throw BusError(fmt::format(
                "the server {} of session '{}' has version {} (protocol {}), this program version {} "
                "(protocol {}): they are incompatible; run programs of the same version on all machines",
                peer.process, self.options.session, peer.version, peer.protocol, ETI_VERSION, protocol));
        }
    }
}

SelfCheck self_check(Node& node, bool is_server, std::chrono::milliseconds wait) {
    const Participant& self = *node.impl().participant;
    SelfCheck check;
    check.warnings = self.warnings();
    look_for_stale_memory(check);

    Subscriber<msg::SessionStatus> statuses(node, topics::session_status);
    const auto end = Clock::now() + wait;
    bool found = false;
    while (!found && Clock::now() < end) {
        std::this_thread::sleep_for(std::min<Clock::duration>(poll_interval, end - Clock::now()));
        if (is_server) {
            refuse_second_server(self);
        } else {
            refuse_other_protocol(node);
            found = statuses.matched() > 0 || server_is_starting(self);
        }
    }
    if (!is_server) {
        look_for_server(self, found, check);
    }
    return check;
}

}  // namespace eti::bus
