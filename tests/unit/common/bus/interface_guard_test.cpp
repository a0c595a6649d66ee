// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/guard/interface_guard.hpp"

#include <gmock/gmock.h>
#include <sched.h>

#include <cstdlib>

#include "common/bus/transport.hpp"
#include "common/process/guard.hpp"
#include "tests/support/bus_domain.hpp"
#include "tests/support/error_of.hpp"

namespace eti::bus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

constexpr int impossible = 77;

/// Runs in a network of its own: d0 with 192.0.2.7/24, e0 with 198.51.100.7/24, and 203.0.113.0/24 behind d0.
GuardedResult on_two_networks(const std::function<int()>& run) {
    return run_guarded([&] {
        if (::unshare(CLONE_NEWNET) != 0 || std::system("ip link add d0 type veth peer name d1") != 0) {
            return impossible;
        }
        if (std::system("ip link set lo up && ip link add e0 type veth peer name e1 && "
                        "ip address add 192.0.2.7/24 dev d0 && ip address add 198.51.100.7/24 dev e0 && "
                        "for i in d0 d1 e0 e1; do ip link set $i up; done && "
                        "ip route add 203.0.113.0/24 via 192.0.2.1") != 0) {
            return 1;
        }
        return run();
    });
}

void expect_success(const GuardedResult& tried) {
    if (tried.status == impossible) {
        GTEST_SKIP() << "no virtual networks here";
    }
    EXPECT_FALSE(tried.broken) << *tried.broken;
    EXPECT_EQ(tried.status, 0);
}

TEST(InterfaceGuard, LeadsToNetworksOfItsInterfaceOnly) {
    expect_success(on_two_networks([] {
        InterfaceGuard guard({"192.0.2.7"});
        const bool near = guard.leads_to({192, 0, 2, 9}) && guard.leads_to({203, 0, 113, 9});
        const bool own = guard.leads_to({127, 0, 0, 1}) && guard.leads_to({192, 0, 2, 7});
        const bool other = guard.leads_to({198, 51, 100, 9}) || guard.leads_to({198, 51, 100, 7});
        const bool nowhere = guard.leads_to({233, 252, 0, 1}) || guard.leads_to({8, 8, 8, 8});
        return (near ? 0 : 2) + (own ? 0 : 4) + (other ? 8 : 0) + (nowhere ? 16 : 0);
    }));
}

TEST(InterfaceGuard, FollowsAChangedRoute) {
    expect_success(on_two_networks([] {
        InterfaceGuard guard({"192.0.2.7"});
        const auto start = InterfaceGuard::Clock::now();
        if (!guard.leads_to({203, 0, 113, 9}, start) ||
            std::system("ip route replace 203.0.113.0/24 via 198.51.100.1") != 0) {
            return 2;
        }
        const bool still = guard.leads_to({203, 0, 113, 9}, start + InterfaceGuard::kept_for - 1ms);
        return still && !guard.leads_to({203, 0, 113, 9}, start + InterfaceGuard::kept_for) ? 0 : 3;
    }));
}

TEST(InterfaceGuard, InterfaceIsFoundByNameOrAddress) {
    expect_success(on_two_networks([] {
        const auto addresses = [](const std::string& name) {
            return only_addresses({.network = true, .interface = name});
        };
        const std::vector<std::string> wanted{"192.0.2.7"};
        return addresses("d0") == wanted && addresses("192.0.2.7") == wanted ? 0 : 2;
    }));
}

TEST(InterfaceGuard, FaultsNameTheirRemedy) {
    const auto fault = [](const Options& options) -> std::string {
        return eti::test::error_of<BusError>([&] { (void)only_addresses(options); });
    };
    EXPECT_THAT(fault({.network = true, .interface = "wg77"}),
                AllOf(HasSubstr("--interface wg77"), HasSubstr("wg-quick up wg77")));
    EXPECT_THAT(fault({.interface = "lo"}), HasSubstr("give --network, --peer or --discovery-server"));
    EXPECT_THAT(fault({.profile = "lab.xml", .interface = "lo"}), HasSubstr("interfaceWhiteList"));
    EXPECT_EQ(fault({.network = true}), "");
}

}  // namespace
}  // namespace eti::bus
