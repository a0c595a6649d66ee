// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>

#include "common/bus/bus.hpp"
#include "devices/haptics/scene_link.hpp"

namespace eti::bench {

/// eti-server as a child process in a session of its own; terminated by the destructor.
class ServerProcess {
  public:
    ServerProcess(const std::string& scenario, const std::string& session, int domain) {
        const std::string program =
            (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "eti-server").string();
        const std::string number = std::to_string(domain);
        process_ = ::fork();
        if (process_ == 0) {
            ::prctl(PR_SET_PDEATHSIG, SIGTERM);  // a killed bench leaves no server at real-time priority
            const int silence = ::open("/dev/null", O_WRONLY);
            ::dup2(silence, STDERR_FILENO);
            ::dup2(silence, STDOUT_FILENO);
            ::execl(program.c_str(), "eti-server", "--scenario", scenario.c_str(), "--session",
                    session.c_str(), "--domain", number.c_str(), nullptr);
            ::_exit(127);
        }
    }
    ~ServerProcess() {
        ::kill(process_, SIGINT);
        for (int tenths = 0; ::waitpid(process_, nullptr, WNOHANG) == 0; ++tenths) {
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
            if (tenths == 100) {
                ::kill(process_, SIGKILL);
            }
        }
    }
    ServerProcess(const ServerProcess&) = delete;
    ServerProcess& operator=(const ServerProcess&) = delete;

    void check() const {
        if (::waitpid(process_, nullptr, WNOHANG) != 0) {
            throw std::runtime_error(
                "eti-server ended by itself; is it beside this program and does it run?");
        }
    }

    /// Waits until the server publishes its scene to `link`. Throws std::runtime_error when it does not.
    [[nodiscard]] devices::InitialScene scene(const devices::SceneLink& link) const {
        constexpr std::chrono::seconds patience{120};  // until the server has built its model
        const auto end = std::chrono::steady_clock::now() + patience;
        std::optional<devices::InitialScene> around;
        while (!(around = link.initial_scene())) {
            check();
            if (std::chrono::steady_clock::now() > end) {
                throw std::runtime_error("eti-server showed no scene within 120 s");
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        return *around;
    }

  private:
    pid_t process_ = -1;
};

/// A domain that other benches and tests on this machine are unlikely to use.
[[nodiscard]] inline int bench_domain() {
    return 101 + ::getpid() % 100;
}

[[nodiscard]] inline bus::Options place(const std::string& session, int domain, const char* name) {
    bus::Options options;
    options.session = session;
    options.domain = domain;
    options.name = name;
    return options;
}

}  // namespace eti::bench
