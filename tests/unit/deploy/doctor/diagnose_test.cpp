// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// Findings for machines that are broken in one way each.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "deploy/doctor/graphics.hpp"
#include "deploy/doctor/machine.hpp"
#include "deploy/doctor/network.hpp"

namespace eti::doctor {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

const Interface loopback{"lo", "127.0.0.1", true, true, false, 65536, true};
const Interface cable{"eth0", "192.0.2.7", true, false, true, 1500, true};

auto is(State state, const std::string& remedy) {
    return AllOf(Field(&Finding::state, state), Field(&Finding::remedy, HasSubstr(remedy)));
}

auto all_well() {
    return Each(AllOf(Field(&Finding::state, State::ok), Field(&Finding::remedy, IsEmpty())));
}

Interface changed(Interface one, void (*change)(Interface&)) {
    change(one);
    return one;
}

TEST(JudgeInterfaces, HealthyMachinePasses) {
    EXPECT_THAT(diagnose_interfaces({loopback, cable}, true, true), all_well());
    EXPECT_THAT(diagnose_interfaces({loopback}, false, true), all_well());
}

TEST(JudgeInterfaces, LoopbackDownIsAFault) {
    const Interface down = changed(loopback, [](Interface& one) { one.up = false; });
    EXPECT_THAT(diagnose_interfaces({down, cable}, false, true),
                Contains(is(State::problem, "ip link set lo up")));
    EXPECT_THAT(diagnose_interfaces({}, false, true), Contains(is(State::problem, "ip link set lo up")));
}

TEST(JudgeInterfaces, NetworkFaultsMatterOnlyWithNetwork) {
    EXPECT_THAT(diagnose_interfaces({loopback}, true, true), Contains(is(State::problem, "omit --network")));
    const Interface mute = changed(cable, [](Interface& one) { one.multicast_returns = false; });
    EXPECT_THAT(diagnose_interfaces({loopback, mute}, true, true),
                AllOf(Contains(is(State::problem, "--peer ADDRESS")), Contains(is(State::info, "firewall"))));
    EXPECT_THAT(diagnose_interfaces({loopback, mute}, true, false), all_well());
    EXPECT_THAT(diagnose_interfaces({loopback, mute}, false, true), all_well());
}

// 1400 bytes, 8 of UDP, 20 of IP.
TEST(JudgeInterfaces, TooSmallMtuIsNamed) {
    const Interface narrow = changed(cable, [](Interface& one) { one.mtu = 1427; });
    EXPECT_THAT(diagnose_interfaces({loopback, narrow}, false, true), Contains(is(State::info, "mtu 1500")));
    const Interface enough = changed(cable, [](Interface& one) { one.mtu = 1428; });
    EXPECT_THAT(diagnose_interfaces({loopback, enough}, false, true), all_well());
}

TEST(JudgeBuffers, SmallBuffersNameTheCommand) {
    EXPECT_THAT(diagnose_buffers({4 << 20, 4 << 20}), all_well());
    EXPECT_THAT(diagnose_buffers({212992, 4 << 20}),
                ElementsAre(is(State::problem, "sysctl -w net.core.rmem_max=4194304"), is(State::ok, "")));
    EXPECT_THAT(diagnose_buffers({4 << 20, -1}), Contains(is(State::info, "net.core.wmem_max")));
}

TEST(JudgeSharedMemory, IsAFaultOnlyIfAProfileUsesIt) {
    EXPECT_THAT(diagnose_shared_memory({true, 256u << 20, 200u << 20, 0, true}), all_well());
    EXPECT_THAT(diagnose_shared_memory({true, 64u << 20, 1u << 20, 0, true}),
                ElementsAre(is(State::problem, "size=256m")));
    EXPECT_THAT(diagnose_shared_memory({true, 64u << 20, 1u << 20, 0, false}),
                ElementsAre(is(State::info, "size=256m")));
    EXPECT_THAT(diagnose_shared_memory({false, 0, 0, 0, true}), ElementsAre(is(State::problem, "tmpfs")));
    EXPECT_THAT(diagnose_shared_memory({true, 256u << 20, 200u << 20, 3, false}),
                Contains(is(State::info, "fastdds shm clean")));
}

TEST(SharedMemory, FolderIsMeasured) {
    const SharedMemory there = shared_memory(fs::temp_directory_path(), false);
    EXPECT_TRUE(there.there);
    EXPECT_GE(there.size, there.free);
    EXPECT_GT(there.size, 0u);
    EXPECT_FALSE(shared_memory("/no/such/folder", false).there);
}

TEST(JudgeRenderer, SoftwareRenderingIsNamed) {
    EXPECT_EQ(diagnose_renderer("NVIDIA RTX A4000", "").state, State::ok);
    EXPECT_THAT(diagnose_renderer("llvmpipe (LLVM 15.0.6, 256 bits)", ""), is(State::info, "graphics card"));
    EXPECT_THAT(diagnose_renderer("", "libEGL.so.1 is not installed"), is(State::info, "libegl-mesa0"));
}

TEST(OpenXr, RuntimePathsFollowTheLoader) {
    const fs::path folder = fs::temp_directory_path() / ("eti-openxr-" + std::to_string(::getpid()));
    fs::create_directories(folder / "openxr/1");
    ::unsetenv("XR_RUNTIME_JSON");
    ::setenv("XDG_CONFIG_HOME", folder.c_str(), 1);
    ::setenv("XDG_CONFIG_DIRS", "/one:/two", 1);
    const fs::path own = folder / "openxr/1/active_runtime.json";
    EXPECT_THAT(openxr_runtime_paths(),
                ElementsAre(own, "/one/openxr/1/active_runtime.json", "/two/openxr/1/active_runtime.json",
                            "/etc/openxr/1/active_runtime.json"));
    EXPECT_THAT(diagnose_openxr(true, {own}), is(State::info, "XR_RUNTIME_JSON"));
    EXPECT_THAT(diagnose_openxr(false, {own}), is(State::info, "libopenxr-loader1"));
    std::ofstream(own) << "{}";
    EXPECT_EQ(diagnose_openxr(true, {"/none", own}).state, State::ok);
    ::setenv("XR_RUNTIME_JSON", "/mine.json", 1);
    EXPECT_THAT(openxr_runtime_paths(), ElementsAre("/mine.json"));
    ::unsetenv("XR_RUNTIME_JSON");
    fs::remove_all(folder);
}

TEST(Identity, FaultIsSplitIntoFindingAndRemedy) {
    bus::Options options;
    EXPECT_THAT(identity(options), all_well());
    options.identity = "/no/such/folder";
    EXPECT_THAT(identity(options), ElementsAre(AllOf(is(State::problem, "make_lab.sh"),
                                                     Field(&Finding::text, HasSubstr("no such folder")))));
}

}  // namespace
}  // namespace eti::doctor
