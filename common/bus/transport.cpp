// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/transport.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <fmt/ranges.h>

#include <charconv>
#include <memory>
#include <sstream>
#include <utility>

#include "common/bus/discovery/discovery_server.hpp"
#include "common/bus/discovery/interface_watcher.hpp"
#include "common/bus/fastdds/settings.hpp"
#include "common/bus/library_log.hpp"
#include "common/process/files/descriptor.hpp"

namespace eti::bus {

namespace {

// Sized for a burst of 240 kB at 90 Hz; the kernel's default of 208 kB loses three quarters of it.
constexpr std::uint32_t socket_buffer = 4u << 20;
// Participants probed on each host; the library's default of 4 misses a fifth program.
constexpr std::uint32_t participants_per_machine = 32;
constexpr const char* loopback = "127.0.0.1";

/// Throws for an IPv6 address: locators of this project are IPv4, whose multicast groups and firewalls a lab
/// has.
void refuse_ipv6(const std::string& host, const char* option) {
    in6_addr ignored{};
    const std::string bare = host.starts_with('[') ? host.substr(1, host.find(']') - 1) : host;
    const std::string address = bare.substr(0, bare.find('%'));
    if (::inet_pton(AF_INET6, address.c_str(), &ignored) == 1) {
        throw BusError(fmt::format(
            "{} {}: is an IPv6 address, and sessions use IPv4; give the machine's IPv4 address (ip -4 "
            "address), or connect both by a tunnel that has IPv4 addresses (docs/network.md)",
            option, host));
    }
}

rtps::Locator_t locator_of(const std::string& host, const char* option) {
    refuse_ipv6(host, option);
    addrinfo wanted{};
    wanted.ai_family = AF_INET;
    wanted.ai_socktype = SOCK_DGRAM;
    addrinfo* found = nullptr;
    if (const int error = ::getaddrinfo(host.c_str(), nullptr, &wanted, &found); error != 0) {
        throw BusError(fmt::format(
            "{} {}: no IPv4 address found ({}); give an address, or a name that 'getent hosts {}' resolves",
            option, host, ::gai_strerror(error), host));
    }
    char text[INET_ADDRSTRLEN] = {};
    ::inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(found->ai_addr)->sin_addr, text, sizeof text);
    ::freeaddrinfo(found);
    rtps::Locator_t locator;
    rtps::IPLocator::setIPv4(locator, text);
    return locator;
}

void add_peers(const std::vector<std::string>& peers, dds::DomainParticipantQos& qos) {
    auto& list = qos.wire_protocol().builtin.initialPeersList;
    list.push_back(locator_of(loopback, "--peer"));
    for (const std::string& peer : peers) {
        list.push_back(locator_of(peer, "--peer"));
    }
}

/// As used by 'fastdds discovery --server-id'.
std::string server_prefix(std::size_t number) {
    return fmt::format("44.53.{:02x}.5f.45.50.52.4f.53.49.4d.41", number);
}

/// HOST or HOST:PORT; the index in the list is the server's id, as in 'fastdds discovery --server-id'.
void add_discovery_servers(const std::vector<std::string>& servers, dds::DomainParticipantQos& qos) {
    for (std::size_t id = 0; id < servers.size(); ++id) {
        const std::string& server = servers[id];
        refuse_ipv6(server, "--discovery-server");
        const std::size_t colon = server.rfind(':');
        std::uint16_t port = discovery_port;
        if (colon != std::string::npos) {
            const char* const end = server.data() + server.size();
            const auto [stop, error] = std::from_chars(server.data() + colon + 1, end, port);
            if (error != std::errc() || stop != end || port == 0) {
                throw BusError(
                    fmt::format("--discovery-server {}: expected HOST or HOST:PORT with a port from 1 to "
                                "65535 (default {})",
                                server, discovery_port));
            }
        }
        rtps::Locator_t locator = locator_of(server.substr(0, colon), "--discovery-server");
        rtps::IPLocator::setPhysicalPort(locator, port);
        add_discovery_server(locator, server_prefix(id), qos);
    }
}

dds::DomainParticipantQos profile_qos(const std::filesystem::path& file) {
    if (!std::filesystem::is_regular_file(file)) {
        throw BusError(fmt::format(
            "profile {}: no such file; give the path of a Fast DDS XML profile (examples: deploy/data/dds)",
            file.string()));
    }
    dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
    const ProfileResult result = read_profile(file, "eti", qos);
    if (result == ProfileResult::invalid_file) {
        throw BusError(
            fmt::format("profile {}: not a valid Fast DDS XML profile (the lines above say where); compare "
                        "deploy/data/dds",
                        file.string()));
    }
    if (result == ProfileResult::no_such_profile) {
        throw BusError(fmt::format(
            "profile {}: holds no <participant profile_name=\"eti\">; name the participant profile 'eti'",
            file.string()));
    }
    return qos;
}

/// UDP on loopback and `only`, or on every interface if nothing is given. No shared memory: a process that is
/// killed or starved while it holds one of the library's locks there ends or stalls the others
/// (docs/decisions/bus-transport.md).
void use_own_transports(const std::vector<std::string>& only, dds::DomainParticipantQos& qos) {
    auto udp = std::make_shared<transport::UDPv4TransportDescriptor>();
    udp->sendBufferSize = socket_buffer;
    udp->receiveBufferSize = socket_buffer;
    udp->maxInitialPeersRange = participants_per_machine;
    udp->interfaceWhiteList = only;
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports = {udp};
    qos.transport().send_socket_buffer_size = socket_buffer;
    qos.transport().listen_socket_buffer_size = socket_buffer;
}

/// Warns when the kernel grants less than requested, which it does silently.
void check_socket_buffer(int option, const char* kernel_setting, std::vector<std::string>& warnings) {
    const Descriptor probe(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    if (!probe) {
        return;  // the participant itself reports a missing network
    }
    const int wanted = static_cast<int>(socket_buffer);
    int granted = 0;
    socklen_t size = sizeof granted;
    ::setsockopt(probe.get(), SOL_SOCKET, option, &wanted, sizeof wanted);
    // Linux reports twice the usable size.
    if (::getsockopt(probe.get(), SOL_SOCKET, option, &granted, &size) == 0 && granted / 2 < wanted) {
        warnings.push_back(fmt::format(
            "the kernel grants socket buffers of {} kB, but large messages need {} kB; run: sysctl -w {}={}",
            granted / 2048, wanted / 1024, kernel_setting, wanted));
    }
}

}  // namespace

bool this_machine_only(const Options& options) {
    return options.profile.empty() && !options.network && options.peers.empty() &&
           options.discovery_servers.empty();
}

std::vector<std::string> only_addresses(const Options& options) {
    const std::string& wanted = options.interface;
    if (wanted.empty()) {
        return {};
    }
    if (!options.profile.empty()) {
        throw BusError(fmt::format(
            "--interface {} together with --profile {}: the profile's interfaceWhiteList already defines the "
            "interfaces; give one of the two",
            wanted, options.profile.string()));
    }
    if (this_machine_only(options)) {
        throw BusError(fmt::format(
            "--interface {}: this program reaches its own machine only; give --network, --peer or "
            "--discovery-server, too, or omit --interface",
            wanted));
    }
    std::vector<std::string> found, all = network_addresses();
    for (const std::string& one : all) {
        const std::size_t space = one.rfind(' ');
        if (wanted == one.substr(0, space) || wanted == one.substr(space + 1)) {
            found.push_back(one.substr(space + 1));
        }
    }
    if (found.empty()) {
        throw BusError(fmt::format(
            "--interface {}: no such interface is up with an IPv4 address; there {}; bring it up (wg-quick "
            "up "
            "{}), or give another",
            wanted, all.empty() ? std::string("is none") : fmt::format("are {}", fmt::join(all, ", ")),
            wanted));
    }
    return found;
}

dds::DomainParticipantQos participant_qos(const Options& options, std::vector<std::string>& warnings) {
    const bool by_peers = !options.peers.empty(), by_server = !options.discovery_servers.empty();
    if (!options.profile.empty() && (by_peers || by_server || options.network)) {
        throw BusError(
            fmt::format("--profile {} together with {}: the profile already defines how others are reached; "
                        "give one of the two",
                        options.profile.string(),
                        reach({.peers = options.peers,
                               .network = options.network,
                               .discovery_servers = options.discovery_servers})));
    }
    if (by_peers && by_server) {
        throw BusError(
            "--peer together with --discovery-server: the server already does the discovery; give one of the "
            "two");
    }
    if (!options.profile.empty()) {
        dds::DomainParticipantQos qos = profile_qos(options.profile);
        if (qos.transport().use_builtin_transports) {
            // The library's own transports would have no filter in front.
            const auto given = qos.transport().user_transports;
            use_own_transports({}, qos);
            qos.transport().user_transports.insert(qos.transport().user_transports.end(), given.begin(),
                                                   given.end());
        }
        return qos;
    }
    dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
    std::vector<std::string> only = only_addresses(options);
    if (!only.empty() || this_machine_only(options)) {
        only.emplace_back(loopback);
    }
    use_own_transports(only, qos);
    if (by_peers) {
        add_peers(options.peers, qos);
    } else if (by_server) {
        add_discovery_servers(options.discovery_servers, qos);
    }
    if (!this_machine_only(options) && network_addresses().empty()) {
        warnings.push_back(fmt::format(
            "{}: no interface to other machines is up with an IPv4 address. Remedy: plug in a cable "
            "or bring one up (ip link), and restart this program; IPv6 addresses are not used",
            reach(options)));
    }
    check_socket_buffer(SO_RCVBUF, "net.core.rmem_max", warnings);
    check_socket_buffer(SO_SNDBUF, "net.core.wmem_max", warnings);
    return qos;
}

dds::DomainParticipantQos discovery_server_qos(int number, const std::string& address, std::uint16_t port,
                                               std::vector<std::string>& warnings) {
    dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
    use_own_transports({}, qos);
    make_discovery_server(qos);
    std::istringstream(server_prefix(static_cast<std::size_t>(number))) >> qos.wire_protocol().prefix;
    rtps::Locator_t locator = locator_of(address.empty() ? "0.0.0.0" : address, "--address");
    rtps::IPLocator::setPhysicalPort(locator, port);
    qos.wire_protocol().builtin.metatrafficUnicastLocatorList.push_back(locator);
    check_socket_buffer(SO_RCVBUF, "net.core.rmem_max", warnings);
    return qos;
}

std::optional<rtps::Locator_t> multicast_locator(const Options& options, std::size_t topic) {
    if (!options.profile.empty() || !options.peers.empty() || !options.discovery_servers.empty()) {
        return std::nullopt;
    }
    // A site-local group beside the discovery group. One port per topic, because the library joins one group
    // per port.
    rtps::Locator_t locator;
    rtps::IPLocator::setIPv4(locator, "239.255.18.1");
    locator.port = first_port + ports_per_domain * static_cast<std::uint32_t>(options.domain) +
                   topic_ports_offset + static_cast<std::uint32_t>(topic);
    return locator;
}

std::string reach(const Options& options) {
    std::string text;
    const auto add = [&](const std::string& more) { text += (text.empty() ? "" : ", ") + more; };
    if (!options.profile.empty()) {
        add("--profile " + options.profile.string());
    }
    if (options.network) {
        add("--network");
    }
    for (const std::string& peer : options.peers) {
        add("--peer " + peer);
    }
    for (const std::string& server : options.discovery_servers) {
        add("--discovery-server " + server);
    }
    if (!options.interface.empty()) {
        add("--interface " + options.interface);
    }
    return text.empty() ? "this machine only" : text;
}

}  // namespace eti::bus
