// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// Reference: sd_notify(3) and sd_watchdog_enabled(3).
#include "common/process/service_notify.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <thread>
#include <vector>

namespace eti {
namespace {

class ServiceNotifyTest : public ::testing::Test {
  protected:
    ~ServiceNotifyTest() override {
        for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) {
            ::unsetenv(name);
        }
        if (manager_ >= 0) {
            ::close(manager_);
        }
        std::filesystem::remove(path_);
    }

    /// Sets the environment as the service manager does.
    void listen(const std::string& address, long watchdog_us = 0, pid_t pid = 0) {
        manager_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
        sockaddr_un own{};
        own.sun_family = AF_UNIX;
        std::memcpy(own.sun_path, address.data(), address.size());
        if (address[0] == '@') {
            own.sun_path[0] = '\0';
        }
        const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address.size());
        ASSERT_EQ(::bind(manager_, reinterpret_cast<sockaddr*>(&own), length), 0) << std::strerror(errno);
        ::setenv("NOTIFY_SOCKET", address.c_str(), 1);
        if (watchdog_us != 0) {
            ::setenv("WATCHDOG_USEC", std::to_string(watchdog_us).c_str(), 1);
        }
        if (pid != 0) {
            ::setenv("WATCHDOG_PID", std::to_string(pid).c_str(), 1);
        }
    }

    std::vector<std::string> heard() const {
        std::vector<std::string> all;
        std::array<char, 256> text{};
        for (ssize_t size = 0; (size = ::recv(manager_, text.data(), text.size(), 0)) >= 0;) {
            all.emplace_back(text.data(), static_cast<std::size_t>(size));
        }
        return all;
    }

    std::string path_ =
        (std::filesystem::temp_directory_path() / ("eti-notify-" + std::to_string(::getpid()))).string();
    int manager_ = -1;
};

using Said = std::vector<std::string>;

TEST_F(ServiceNotifyTest, ReadyAndStoppingAreSentOnce) {
    listen(path_);
    ServiceNotify notify;
    EXPECT_EQ(heard(), Said{});
    for (int i = 0; i < 10; ++i) {
        notify.alive();
    }
    notify.say("all is well");
    notify.ending();
    EXPECT_EQ(heard(), (Said{"READY=1", "STATUS=all is well", "STOPPING=1"}));
}

TEST_F(ServiceNotifyTest, AbstractAddressesWork) {
    listen("@eti-notify-" + std::to_string(::getpid()));
    ServiceNotify notify;
    notify.alive();
    EXPECT_EQ(heard(), Said{"READY=1"});
}

TEST_F(ServiceNotifyTest, WatchdogIsNotifiedFourTimesPerPeriod) {
    using namespace std::chrono_literals;
    listen(path_, 200'000, ::getpid());
    ServiceNotify notify;
    const auto start = std::chrono::steady_clock::now();
    auto last = start;
    std::chrono::duration<double, std::milli> latest{0.0};
    while (last < start + 500ms) {
        notify.alive();
        const auto now = std::chrono::steady_clock::now();
        latest = std::max<std::chrono::duration<double, std::milli>>(latest, now - last);
        last = now;
        std::this_thread::sleep_for(1ms);
    }
    const std::chrono::duration<double, std::milli> took = last - start;
    const auto said = heard();
    const auto times = std::count(said.begin(), said.end(), "WATCHDOG=1");
    EXPECT_EQ(times + 1, static_cast<long>(said.size()));
    // One at first and one every 50 ms; a late call adds its lateness.
    EXPECT_LE(times, took.count() / 50.0 + 1.0);
    EXPECT_GE(times, std::floor(took.count() / (50.0 + latest.count())));
    std::this_thread::sleep_for(100ms);
    EXPECT_EQ(heard(), Said{}) << "nothing speaks for a loop that hangs";
}

TEST_F(ServiceNotifyTest, OtherProcessesWatchdogIsIgnored) {
    listen(path_, 1, ::getppid());
    ServiceNotify notify;
    notify.alive();
    notify.alive();
    EXPECT_EQ(heard(), Said{"READY=1"});
}

TEST_F(ServiceNotifyTest, InvalidEnvironmentIsIgnored) {
    for (const std::string& address :
         {std::string(), std::string("/"), std::string("vsock:2:1"), std::string("relative"),
          "/" + std::string(200, 'x'), std::string("/nobody/listens")}) {
        ::setenv("NOTIFY_SOCKET", address.c_str(), 1);
        ServiceNotify notify;
        notify.alive();
        notify.ending();
    }
    listen(path_);
    for (const char* span : {"", "0", "-5", "5x", "99999999999999999999"}) {
        ::setenv("WATCHDOG_USEC", span, 1);
        ServiceNotify notify;
        notify.alive();
        EXPECT_EQ(heard(), Said{"READY=1"}) << span;
    }
}

TEST_F(ServiceNotifyTest, FullSocketDoesNotBlock) {
    listen(path_);
    ServiceNotify notify;
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < 10'000; ++i) {
        notify.say("again");
    }
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::minutes(1));
    EXPECT_LT(heard().size(), 10'000u);
}

}  // namespace
}  // namespace eti
