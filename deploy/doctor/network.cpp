// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "deploy/doctor/network.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <random>

#include "common/process/files/descriptor.hpp"

namespace eti::doctor {

namespace {

constexpr const char* test_group = "239.255.86.84";  // in the range for private use, RFC 2365
constexpr int answer_time_ms = 200;
constexpr int least_mtu = 1428;  // [bytes] a datagram of 1400 with its UDP and IP headers
constexpr int common_mtu = 1500;
constexpr long wanted_buffer = 4L << 20;  // [bytes] requested by common/bus/transport.cpp

Descriptor udp_socket() {
    return Descriptor(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
}

int mtu_of(const std::string& name) {
    const Descriptor probe = udp_socket();
    ifreq request{};
    name.copy(request.ifr_name, IFNAMSIZ - 1);
    return ::ioctl(probe.get(), SIOCGIFMTU, &request) == 0 ? request.ifr_mtu : 0;
}

/// Whether a member on the interface receives what is sent through it to a group.
bool multicast_returns(const in_addr& own) {
    const Descriptor member = udp_socket(), sender = udp_socket();
    sockaddr_in address{};
    address.sin_family = AF_INET;
    ::inet_pton(AF_INET, test_group, &address.sin_addr);
    socklen_t size = sizeof address;
    const ip_mreq membership{address.sin_addr, own};
    if (::bind(member.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
        ::getsockname(member.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0 ||
        ::setsockopt(member.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) != 0 ||
        ::setsockopt(sender.get(), IPPROTO_IP, IP_MULTICAST_IF, &own, sizeof own) != 0) {
        return false;
    }
    const std::uint64_t nonce = (std::uint64_t{std::random_device()()} << 32) | std::random_device()();
    if (::sendto(sender.get(), &nonce, sizeof nonce, 0, reinterpret_cast<const sockaddr*>(&address),
                 sizeof address) != sizeof nonce) {
        return false;
    }
    pollfd waiting{member.get(), POLLIN, 0};
    std::uint64_t heard = 0;
    return ::poll(&waiting, 1, answer_time_ms) == 1 &&
           ::recv(member.get(), &heard, sizeof heard, 0) == sizeof heard && heard == nonce;
}

long number_in(const char* file) {
    long number = -1;
    std::ifstream(file) >> number;
    return number;
}

Finding diagnose_interface(const Interface& one, bool by_multicast) {
    Finding finding{"network", one.name, State::ok,
                    fmt::format("{}, MTU {}, {}", one.address, one.mtu,
                                !one.up                 ? "down"
                                : one.multicast_returns ? "multicast"
                                                        : "no multicast"),
                    ""};
    if (!one.up) {
        finding.state = one.loopback ? State::problem : State::info;
        finding.remedy = fmt::format("bring it up: ip link set {} up", one.name);
    } else if (one.mtu < least_mtu) {
        finding.state = State::info;
        finding.remedy = fmt::format(
            "datagrams of the bus have 1400 bytes plus headers: {} fragments them, and one lost fragment "
            "loses the datagram; raise it: ip link set {} mtu {}",
            one.name, one.name, common_mtu);
    } else if (!one.loopback && by_multicast && !one.multicast_returns) {
        finding.state = State::info;
        finding.remedy = fmt::format("{}; or name the other machines: --peer ADDRESS",
                                     one.multicast ? "a firewall may block it: allow UDP to 239.255.0.0/16"
                                                   : fmt::format("ip link set {} multicast on", one.name));
    }
    return finding;
}

}  // namespace

std::vector<Interface> interfaces() {
    std::vector<Interface> all;
    ifaddrs* list = nullptr;
    if (::getifaddrs(&list) != 0) {
        return all;
    }
    const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owned(list, &::freeifaddrs);
    for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
        const bool is_address = one->ifa_addr != nullptr && one->ifa_addr->sa_family == AF_INET;
        // A loopback without an address is down and stops the whole bus, so it is reported too.
        const bool silent_loopback = (one->ifa_flags & IFF_LOOPBACK) != 0 && (one->ifa_flags & IFF_UP) == 0;
        if (!is_address && !silent_loopback) {
            continue;
        }
        Interface found;
        found.name = one->ifa_name;
        found.up = (one->ifa_flags & IFF_UP) != 0;
        found.loopback = (one->ifa_flags & IFF_LOOPBACK) != 0;
        found.multicast = (one->ifa_flags & IFF_MULTICAST) != 0;
        found.mtu = mtu_of(found.name);
        found.address = "no address";
        if (is_address) {
            const in_addr address = reinterpret_cast<const sockaddr_in*>(one->ifa_addr)->sin_addr;
            std::array<char, INET_ADDRSTRLEN> text{};
            ::inet_ntop(AF_INET, &address, text.data(), text.size());
            found.address = text.data();
            found.multicast_returns = found.up && multicast_returns(address);
        }
        all.push_back(found);
    }
    return all;
}

Findings diagnose_interfaces(const std::vector<Interface>& all, bool reaches_network, bool by_multicast) {
    Findings findings;
    for (const Interface& one : all) {
        findings.push_back(diagnose_interface(one, reaches_network && by_multicast));
    }
    if (std::ranges::none_of(all, [](const Interface& one) { return one.up && one.loopback; })) {
        findings.push_back({"network", "loopback", State::problem, "no loopback interface is up",
                            "programs on this machine do not find each other; run: ip link set lo up"});
    }
    const auto is_outer = [](const Interface& one) { return one.up && !one.loopback; };
    if (reaches_network && std::ranges::none_of(all, is_outer)) {
        findings.push_back({"network", "others", State::problem, "no interface to other machines is up",
                            "plug in a cable or bring one up (ip link), or omit --network and --peer"});
    } else if (reaches_network && by_multicast && std::ranges::none_of(all, [&](const Interface& one) {
                   return is_outer(one) && one.multicast_returns;
               })) {
        findings.push_back({"network", "multicast", State::problem,
                            "no interface to other machines has multicast",
                            "name the other machines instead: --peer ADDRESS"});
    }
    return findings;
}

SocketBuffers socket_buffers() {
    return {number_in("/proc/sys/net/core/rmem_max"), number_in("/proc/sys/net/core/wmem_max")};
}

Findings diagnose_buffers(const SocketBuffers& buffers) {
    Findings findings;
    const auto add = [&](const char* name, const char* key, long bytes) {
        Finding finding{"buffers", name, State::ok, fmt::format("at most {} kB per socket", bytes / 1024),
                        ""};
        if (bytes < 0) {
            finding.state = State::info;
            finding.text = "the kernel does not report the largest socket buffer";
            finding.remedy = fmt::format("see {}, outside a container", key);
        } else if (bytes < wanted_buffer) {
            finding.state = State::problem;
            finding.remedy = fmt::format("bursts that need {} kB are lost; run: sysctl -w {}={}",
                                         wanted_buffer / 1024, key, wanted_buffer);
        }
        findings.push_back(finding);
    };
    add("receive", "net.core.rmem_max", buffers.receive);
    add("send", "net.core.wmem_max", buffers.send);
    return findings;
}

}  // namespace eti::doctor
