// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// The programs as a person starts them.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "common/bus/bus.hpp"
#include "tests/support/bus_domain.hpp"

namespace eti::devices {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// A program that runs, its output going to files.
class Running {
  public:
    Running(const char* program, std::vector<std::string> arguments)
        : base_(testing::TempDir() + "eti_program_" + std::to_string(::getpid())) {
        arguments.insert(arguments.begin(), program);
        std::vector<char*> raw;
        for (std::string& argument : arguments) {
            raw.push_back(argument.data());
        }
        raw.push_back(nullptr);
        pid_ = ::fork();
        if (pid_ == 0) {
            ::dup2(::open((base_ + ".out").c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600), STDOUT_FILENO);
            ::dup2(::open((base_ + ".err").c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600), STDERR_FILENO);
            ::execv(program, raw.data());
            ::_exit(127);
        }
    }
    ~Running() {
        if (pid_ > 0) {
            ::kill(pid_, SIGKILL);
            ::waitpid(pid_, nullptr, 0);
        }
        std::remove((base_ + ".out").c_str());
        std::remove((base_ + ".err").c_str());
    }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

    void send(int signal) const { ::kill(pid_, signal); }

    /// Exit status; -1 when a signal ended it, -2 when it did not end in time.
    int wait(std::chrono::seconds limit = 30s) {
        const auto end = std::chrono::steady_clock::now() + limit;
        int status = 0;
        while (::waitpid(pid_, &status, WNOHANG) == 0) {
            if (std::chrono::steady_clock::now() > end) {
                return -2;
            }
            std::this_thread::sleep_for(10ms);
        }
        pid_ = 0;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }

    [[nodiscard]] std::string out() const { return text(".out"); }
    [[nodiscard]] std::string err() const { return text(".err"); }

    [[nodiscard]] bool says(const std::string& words, std::chrono::seconds limit = 20s) const {
        const auto end = std::chrono::steady_clock::now() + limit;
        while (err().find(words) == std::string::npos) {
            if (std::chrono::steady_clock::now() > end) {
                return false;
            }
            std::this_thread::sleep_for(20ms);
        }
        return true;
    }

  private:
    [[nodiscard]] std::string text(const char* suffix) const {
        std::stringstream all;
        all << std::ifstream(base_ + suffix).rdbuf();
        return all.str();
    }

    std::string base_;
    pid_t pid_ = 0;
};

std::vector<std::string> with(const std::string& device, std::vector<std::string> more = {}) {
    more.insert(more.begin(),
                {"--device", device, "--session", "test", "--domain", std::to_string(test::own_domain())});
    return more;
}

class EitherProgram : public ::testing::TestWithParam<std::pair<const char*, const char*>> {
  protected:
    const char* program_ = GetParam().first;
    std::string device_ = GetParam().second;
};

TEST_P(EitherProgram, HelpAndVersion) {
    Running help(program_, {"--help"});
    EXPECT_EQ(help.wait(), 0);
    EXPECT_THAT(help.out(), AllOf(HasSubstr("--operator"), HasSubstr("--duration"), HasSubstr(device_)));
}

TEST_P(EitherProgram, Version) {
    Running version(program_, {"--version"});
    EXPECT_EQ(version.wait(), 0);
    EXPECT_EQ(version.out(), ETI_VERSION "\n");
}

TEST_P(EitherProgram, RefusesAnUnknownDeviceNamingThoseThereAre) {
    Running refused(program_, with("nothing-of-the-kind", {"--json"}));
    EXPECT_GT(refused.wait(), 0);
    EXPECT_THAT(refused.err(), AllOf(HasSubstr("nothing-of-the-kind"), HasSubstr(device_)));
    EXPECT_EQ(refused.out(), "");
}

TEST_P(EitherProgram, RefusesBadOptions) {
    const std::vector<std::vector<std::string>> all = {{},
                                                       {"--duration", "-1"},
                                                       {"--operator", "nobody-of-that-name"},
                                                       {"--session", "*"},
                                                       {"--domain", "233"},
                                                       {"--profile", "/nowhere/profile.xml"}};
    for (const auto& options : all) {
        std::vector<std::string> arguments = options;
        if (!options.empty()) {
            arguments.insert(arguments.end(), {"--device", device_});
        }
        Running refused(program_, arguments);
        EXPECT_GT(refused.wait(), 0) << (options.empty() ? "no options" : options.front());
        EXPECT_NE(refused.err(), "");
        EXPECT_EQ(refused.out(), "");
    }
}

TEST_P(EitherProgram, CtrlCEndsItWithItsStatistics) {
    Running program(program_, with(device_, {"--json"}));
    ASSERT_TRUE(program.says("held still")) << program.err();
    std::this_thread::sleep_for(500ms);
    program.send(SIGINT);
    EXPECT_EQ(program.wait(), 0) << program.err();
    const auto result = nlohmann::json::parse(program.out());
    EXPECT_EQ(result.at("ended"), "interrupted");
    EXPECT_EQ(result.at("outages"), 0);
    // 500 cycles at 1 kHz, 120 at 240 Hz; a third of the slower on a machine shared by many tests.
    EXPECT_GT(result.at("cycles"), 40);
    EXPECT_GT(result.at("poses_published"), 40);
    EXPECT_GT(result.at("cycle_ms").at("p50"), device_ == "simulated" ? 0.9 : 4.0);
    EXPECT_GE(result.at("cycle_ms").at("max"), result.at("cycle_ms").at("p99"));
}

TEST_P(EitherProgram, CtrlCEndsItWhileItWaitsForAServer) {
    Running program(program_, with(device_, {"--json", "--operator", "expert"}));
    ASSERT_TRUE(program.says("waits for the scene")) << program.err();
    program.send(SIGTERM);
    EXPECT_EQ(program.wait(), 0) << program.err();
    EXPECT_EQ(nlohmann::json::parse(program.out()).at("cycles"), 0);
}

TEST_P(EitherProgram, EndsAfterItsDuration) {
    Running program(program_, with(device_, {"--json", "--duration", "2.5"}));
    EXPECT_EQ(program.wait(), 0) << program.err();
    const auto result = nlohmann::json::parse(program.out());
    EXPECT_EQ(result.at("ended"), "duration");
    EXPECT_GE(result.at("duration_s"), 2.5);
}

TEST_P(EitherProgram, EndsWithItsSession) {
    bus::Options options;
    options.session = "test";
    options.domain = test::own_domain();
    options.name = "eti-server";
    bus::Node node(options);
    bus::Publisher<msg::SessionStatus> topic(node, bus::topics::session_status);
    msg::SessionStatus status;
    status.session("test");
    status.phase(msg::PHASE_RUNNING);
    ASSERT_TRUE(topic.publish(status));
    Running program(program_, with(device_, {"--json"}));
    ASSERT_TRUE(program.says("held still")) << program.err();
    EXPECT_EQ(program.err().find("no server"), std::string::npos) << program.err();
    status.phase(msg::PHASE_FINISHED);
    ASSERT_TRUE(topic.publish(status));
    EXPECT_EQ(program.wait(), 0) << program.err();
    EXPECT_EQ(nlohmann::json::parse(program.out()).at("ended"), "session finished");
}

INSTANTIATE_TEST_SUITE_P(Devices, EitherProgram,
                         ::testing::Values(std::pair(ETI_HAPTICS, "simulated"),
                                           std::pair(ETI_TRACKER, "scripted")),
                         [](const auto& run) { return std::string(run.param.second); });

}  // namespace
}  // namespace eti::devices
