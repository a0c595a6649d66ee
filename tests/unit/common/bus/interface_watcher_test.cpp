// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/discovery/interface_watcher.hpp"

#include <gmock/gmock.h>
#include <sched.h>

#include <cstdlib>
#include <mutex>

#include "common/bus/bus.hpp"
#include "common/process/guard.hpp"
#include "tests/support/bus_domain.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/eventually.hpp"

namespace eti::bus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// In a network of its own, an interface gets its address after the watcher has started.
TEST(InterfaceWatcher, ReportsAddressThatAppears) {
    constexpr int impossible = 77;
    const GuardedResult tried = run_guarded([] {
        if (::unshare(CLONE_NEWNET) != 0 || std::system("ip link add d0 type veth peer name d1") != 0) {
            return impossible;
        }
        std::mutex mutex;
        std::string found;
        InterfaceWatcher watcher([&](const std::string& addresses) {
            const std::lock_guard lock(mutex);
            found += addresses + ';';
        });
        if (!network_addresses().empty() ||
            std::system("ip address add 192.0.2.7/24 dev d0 && ip link set d0 up && ip link set d1 up") !=
                0) {
            return 1;
        }
        const bool told = test::eventually([&] {
            const std::lock_guard lock(mutex);
            return found == "d0 192.0.2.7;";
        });
        return told && network_addresses() == std::vector<std::string>{"d0 192.0.2.7"} ? 0 : 2;
    });
    if (tried.status == impossible) {
        GTEST_SKIP() << "no virtual networks here";
    }
    EXPECT_FALSE(tried.broken) << *tried.broken;
    EXPECT_EQ(tried.status, 0);
}

TEST(Transport, Ipv6AddressIsRefusedWithRemedy) {
    const auto refusal = [](const auto& set) -> std::string {
        Options options = test::bus_options("eti-client", "test");
        set(options);
        return eti::test::error_of<BusError>([&] { const Node node(options); });
    };
    for (const char* const address : {"::1", "fe80::1%eth0", "[2001:db8::1]"}) {
        EXPECT_THAT(refusal([&](Options& options) { options.peers = {address}; }),
                    AllOf(HasSubstr("--peer"), HasSubstr(address), HasSubstr("IPv4")));
    }
    for (const char* const address : {"2001:db8::1", "[2001:db8::1]:11811"}) {
        EXPECT_THAT(refusal([&](Options& options) { options.discovery_servers = {address}; }),
                    AllOf(HasSubstr("--discovery-server"), HasSubstr(address), HasSubstr("IPv4")));
    }
}

}  // namespace
}  // namespace eti::bus
