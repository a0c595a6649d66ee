// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// The programs as started by a person.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <pty.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
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

/// A running program with its output in files; its input is a terminal if requested.
class Running {
  public:
    Running(const char* program, std::vector<std::string> arguments, bool terminal = false)
        : base_(testing::TempDir() + "eti_program_" + std::to_string(::getpid())) {
        arguments.insert(arguments.begin(), program);
        std::vector<char*> raw;
        for (std::string& argument : arguments) {
            raw.push_back(argument.data());
        }
        raw.push_back(nullptr);
        pid_ = terminal ? ::forkpty(&terminal_, nullptr, nullptr, nullptr) : ::fork();
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
        hang_up();
        std::remove((base_ + ".out").c_str());
        std::remove((base_ + ".err").c_str());
    }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

    void send(int signal) const { ::kill(pid_, signal); }
    void type(const std::string& keys) const {
        EXPECT_EQ(::write(terminal_, keys.data(), keys.size()), static_cast<ssize_t>(keys.size()));
    }
    /// Closes the terminal, if there is one.
    void hang_up() {
        if (terminal_ >= 0) {
            ::close(terminal_);
            terminal_ = -1;
        }
    }

    /// Exit status; -1 when a signal ended it, -2 when it did not end in time.
    int wait(std::chrono::seconds limit = 120s) {
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

    [[nodiscard]] bool says(const std::string& words, std::chrono::seconds limit = 120s) const {
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
    int terminal_ = -1;
};

std::vector<std::string> with(const std::string& device, std::vector<std::string> more = {}) {
    more.insert(more.begin(),
                {"--device", device, "--session", "test", "--domain", std::to_string(test::own_domain())});
    return more;
}

class DeviceProgram : public ::testing::TestWithParam<std::pair<const char*, const char*>> {
  protected:
    const char* program_ = GetParam().first;
    std::string device_ = GetParam().second;
};

TEST_P(DeviceProgram, HelpAndVersion) {
    Running help(program_, {"--help"});
    EXPECT_EQ(help.wait(), 0);
    EXPECT_THAT(help.out(), AllOf(HasSubstr("--operator"), HasSubstr("--duration"), HasSubstr(device_)));
}

TEST_P(DeviceProgram, Version) {
    Running version(program_, {"--version"});
    EXPECT_EQ(version.wait(), 0);
    EXPECT_EQ(version.out(), ETI_VERSION "\n");
}

TEST_P(DeviceProgram, UnknownDeviceErrorListsTheDevices) {
    Running refused(program_, with("nothing-of-the-kind", {"--json"}));
    EXPECT_GT(refused.wait(), 0);
    EXPECT_THAT(refused.err(), AllOf(HasSubstr("nothing-of-the-kind"), HasSubstr(device_)));
    EXPECT_EQ(refused.out(), "");
}

TEST_P(DeviceProgram, RefusesBadOptions) {
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

TEST_P(DeviceProgram, CtrlCEndsItWithItsStatistics) {
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

TEST_P(DeviceProgram, CtrlCEndsItWhileItWaitsForAServer) {
    Running program(program_, with(device_, {"--json", "--operator", "expert"}));
    ASSERT_TRUE(program.says("waits for the scene")) << program.err();
    program.send(SIGTERM);
    EXPECT_EQ(program.wait(), 0) << program.err();
    EXPECT_EQ(nlohmann::json::parse(program.out()).at("cycles"), 0);
}

TEST_P(DeviceProgram, EndsAfterItsDuration) {
    Running program(program_, with(device_, {"--json", "--duration", "2.5"}));
    EXPECT_EQ(program.wait(), 0) << program.err();
    const auto result = nlohmann::json::parse(program.out());
    EXPECT_EQ(result.at("ended"), "duration");
    EXPECT_GE(result.at("duration_s"), 2.5);
}

TEST_P(DeviceProgram, EndsWithItsSession) {
    bus::Node node(test::bus_options("eti-server"));
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

INSTANTIATE_TEST_SUITE_P(Devices, DeviceProgram,
                         ::testing::Values(std::pair(ETI_HAPTICS, "simulated"),
                                           std::pair(ETI_TRACKER, "scripted")),
                         [](const auto& run) { return std::string(run.param.second); });

/// A program, a device with a vendor's library, and a stand-in for the library.
struct OnVendorsLibrary {
    const char *program, *device, *library;
};
class VendorDevice : public ::testing::TestWithParam<OnVendorsLibrary> {};

TEST_P(VendorDevice, IsReadAndPublished) {
    const auto& [program, device, library] = GetParam();
    Running running(program,
                    with(device, {"--library", library, "--uncalibrated", "--json", "--duration", "2"}));
    EXPECT_EQ(running.wait(), 0) << running.err();
    EXPECT_THAT(running.err(), HasSubstr("is not calibrated"));
    const auto result = nlohmann::json::parse(running.out());
    EXPECT_GT(result.at("poses_published"), 40);
    EXPECT_EQ(result.at("device_losses"), 0);
    EXPECT_EQ(result.at("poses_left_out"), 0);
}

TEST_P(VendorDevice, IsRefusedWithoutCalibration) {
    const auto& [program, device, library] = GetParam();
    Running running(program, with(device, {"--library", library, "--json", "--duration", "2"}));
    EXPECT_GT(running.wait(), 0);
    EXPECT_THAT(running.err(), AllOf(HasSubstr("is not calibrated"), HasSubstr("eti-calibrate"),
                                     HasSubstr("--uncalibrated")));
    EXPECT_EQ(running.out(), "");
}

INSTANTIATE_TEST_SUITE_P(Programs, VendorDevice,
                         ::testing::Values(OnVendorsLibrary{ETI_HAPTICS, "openhaptics", STAND_IN_OPENHAPTICS},
                                           OnVendorsLibrary{ETI_TRACKER, "openhaptics", STAND_IN_OPENHAPTICS},
                                           OnVendorsLibrary{ETI_TRACKER, "trakstar", STAND_IN_TRAKSTAR}),
                         [](const auto& run) {
                             return std::string(run.param.program == std::string(ETI_HAPTICS) ? "haptics_"
                                                                                              : "tracker_") +
                                    run.param.device;
                         });

/// Result of a program that needs no server: exit status, output, log.
struct Done {
    int status;
    std::string out, err;
};
Done run(const char* program, const std::vector<std::string>& arguments) {
    Running running(program, arguments);
    const int status = running.wait(60s);
    return {status, running.out(), running.err()};
}

class Calibrate : public ::testing::Test {
  protected:
    void TearDown() override { std::filesystem::remove_all(folder_); }
    [[nodiscard]] std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
        return (folder_ / name).string();
    }
    std::filesystem::path folder_ = [] {
        const auto folder =
            std::filesystem::path(testing::TempDir()) / ("eti_calibrate_" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder);
        return folder;
    }();
};

// The device's frame is the patient's moved by (10, 20, 30) mm; one point was touched wrongly.
TEST_F(Calibrate, TrackerUsesTheRegistrationResult) {
    std::string pairs = "points:\n";
    const int places[6][3] = {{0, 0, 0}, {50, 0, 0}, {0, 60, 0}, {0, 0, 70}, {50, 60, 0}, {50, 60, 70}};
    for (const auto& p : places) {
        const int wrong = p[0] == 50 && p[1] == 0 ? 25 : 0;
        pairs += "  - {patient_mm: [" + std::to_string(p[0]) + ", " + std::to_string(p[1]) + ", " +
                 std::to_string(p[2]) + "], device_mm: [" + std::to_string(p[0] - 10 + wrong) + ", " +
                 std::to_string(p[1] - 20) + ", " + std::to_string(p[2] - 30) + "]}\n";
    }
    const std::string file = (folder_ / "c.yaml").string();
    const Done done = run(ETI_CALIBRATE, {"register", "--device", "simulated", "--pairs",
                                          write("pairs.yaml", pairs), "--out", file, "--json"});
    ASSERT_EQ(done.status, 0) << done.err;
    const auto result = nlohmann::json::parse(done.out);
    EXPECT_LT(result.at("error_mm"), 1e-3);
    EXPECT_FALSE(result.at("points")[1].at("used"));
    EXPECT_THAT(done.err, HasSubstr("excluded"));

    Running program(ETI_TRACKER, with("simulated", {"--json", "--duration", "2.5", "--calibration", file}));
    EXPECT_EQ(program.wait(), 0) << program.err();
    EXPECT_THAT(program.err(), HasSubstr("5 points"));
    const Done other = run(ETI_TRACKER, with("scripted", {"--calibration", file}));
    EXPECT_GT(other.status, 0);
    EXPECT_THAT(other.err, AllOf(HasSubstr("of device 'simulated'"), HasSubstr("eti-calibrate")));
}

TEST_F(Calibrate, FindsTipAndRefusesDegeneratePoses) {
    std::string poses, still;
    for (int i = 0; i < 40; ++i) {
        const double a = 0.6 * std::sin(0.7 * i), b = 0.6 * std::cos(1.1 * i);
        // Turned about x by a, then about y by b; the tip 100 mm along z stays at the origin.
        const double qw = std::cos(a / 2) * std::cos(b / 2), qx = std::sin(a / 2) * std::cos(b / 2),
                     qy = std::cos(a / 2) * std::sin(b / 2), qz = -std::sin(a / 2) * std::sin(b / 2);
        const double x = 2 * (qx * qz + qw * qy), y = 2 * (qy * qz - qw * qx),
                     z = 1 - 2 * (qx * qx + qy * qy);
        std::stringstream line;
        line.precision(12);
        line << -100 * x << ' ' << -100 * y << ' ' << -100 * z << ' ' << qw << ' ' << qx << ' ' << qy << ' '
             << qz << '\n';
        poses += line.str();
        still += "0 0 -100 1 0 0 0\n";
    }
    const Done done =
        run(ETI_CALIBRATE, {"pivot", "--device", "openhaptics", "--poses", write("p.txt", poses), "--out",
                            (folder_ / "pivot.yaml").string(), "--json"});
    ASSERT_EQ(done.status, 0) << done.err;
    EXPECT_NEAR(nlohmann::json::parse(done.out).at("tip_mm")[2], 100.0, 1e-3);
    const Done as_calibration =
        run(ETI_HAPTICS,
            with("openhaptics", {"--calibration", (folder_ / "pivot.yaml").string(), "--duration", "1"}));
    EXPECT_GT(as_calibration.status, 0);
    EXPECT_THAT(as_calibration.err, HasSubstr("is a pivot"));
    const Done of_another = run(
        ETI_CALIBRATE, {"register", "--device", "trakstar", "--pivot", (folder_ / "pivot.yaml").string()});
    EXPECT_GT(of_another.status, 0);
    EXPECT_THAT(of_another.err, HasSubstr("expected a pivot of 'trakstar'"));
    const Done refused =
        run(ETI_CALIBRATE, {"pivot", "--device", "openhaptics", "--poses", write("s.txt", still)});
    EXPECT_GT(refused.status, 0);
    EXPECT_THAT(refused.err, HasSubstr("rotated too little"));
}

TEST_F(Calibrate, SimulatesTheExpectedError) {
    const Done done = run(ETI_CALIBRATE, {"simulate", "--trials", "50", "--json"});
    ASSERT_EQ(done.status, 0) << done.err;
    for (const auto& row : nlohmann::json::parse(done.out)) {
        EXPECT_LT(row.at("percentile_95_mm"), 2.0) << row;
    }
}

TEST(Controller, SendsCommandsAndReceivesAnswers) {
    bus::Node node(test::bus_options("eti-server"));
    bus::Subscriber<msg::Command> commands(node, bus::topics::command);
    bus::Publisher<msg::CommandResult> answers(node, bus::topics::command_result);
    const std::string pad = testing::TempDir() + "eti_controller_pad_" + std::to_string(::getpid());
    ASSERT_EQ(::mkfifo(pad.c_str(), 0600), 0);
    const int end = ::open(pad.c_str(), O_RDWR | O_CLOEXEC);
    Running program(ETI_CONTROLLER, with("gamepad", {"--source", pad, "--json"}));
    ASSERT_TRUE(program.says("commands from")) << program.err();
    const auto limit = std::chrono::steady_clock::now() + 120s;
    while (commands.matched() == 0 && std::chrono::steady_clock::now() < limit) {
        std::this_thread::sleep_for(10ms);
    }
    const unsigned char pressed[8] = {0, 0, 0, 0, 1, 0, 1, 0};  // time, value 1, button, number 0
    ASSERT_EQ(::write(end, pressed, sizeof pressed), 8);
    msg::Command command;
    bool heard = false;
    while (!heard && std::chrono::steady_clock::now() < limit) {
        (void)commands.wait(100ms);
        heard = commands.take(command);
    }
    ASSERT_TRUE(heard);
    EXPECT_EQ(command.name(), "suction");
    EXPECT_EQ(command.value(), 1.0f);
    msg::CommandResult answer;
    answer.recipient(command.sender());
    answer.id(command.id());
    answer.accepted(false);
    answer.reason("there is no suction here");
    ASSERT_TRUE(answers.publish(answer));
    EXPECT_TRUE(program.says("there is no suction here")) << program.err();
    program.send(SIGINT);
    EXPECT_EQ(program.wait(), 0);
    EXPECT_EQ(nlohmann::json::parse(program.out()).at("refused"), 1);
    ASSERT_TRUE(commands.take(command)) << "the button is still pressed: suction would go on";
    EXPECT_EQ(command.name(), "suction");
    EXPECT_EQ(command.value(), 0.0f);
    ::close(end);
    ::unlink(pad.c_str());
}

TEST(Haptics, EmergencyStopReleasesForceAndIsCounted) {
    Running program(ETI_HAPTICS, with("simulated", {"--json"}));
    ASSERT_TRUE(program.says("held still")) << program.err();
    std::this_thread::sleep_for(300ms);
    program.send(SIGUSR1);
    ASSERT_TRUE(program.says("forces are off")) << program.err();
    std::this_thread::sleep_for(300ms);
    program.send(SIGINT);
    EXPECT_EQ(program.wait(), 0);
    const auto result = nlohmann::json::parse(program.out());
    EXPECT_GT(result.at("stopped_share"), 0.1);
    EXPECT_TRUE(result.contains("energy_mj"));
    EXPECT_GT(result.at("compute_us").at("p99"), 0.0);
}

// Also keys that are not letters: Home, and those that would stop the output or the process.
TEST(Haptics, AnyKeyReleasesAndRRestoresForces) {
    for (const char* key : {" ", "\x1b[H", "\x13", "\x1a"}) {
        Running program(ETI_HAPTICS, with("simulated"), true);
        ASSERT_TRUE(program.says("any key turns forces off")) << program.err();
        program.type(key);
        ASSERT_TRUE(program.says("forces are off", 5s)) << program.err() << static_cast<int>(key[0]);
        program.type("r");
        ASSERT_TRUE(program.says("forces return", 5s)) << program.err();
        program.type("\x03");
        EXPECT_EQ(program.wait(), 0) << program.err();
        EXPECT_THAT(program.err(), HasSubstr("ended: interrupted"));
    }
}

TEST(Haptics, ClosingTheTerminalEndsItCleanly) {
    Running program(ETI_HAPTICS, with("simulated"), true);
    ASSERT_TRUE(program.says("any key turns forces off")) << program.err();
    program.hang_up();
    EXPECT_EQ(program.wait(), 0) << program.err();
    EXPECT_THAT(program.err(), HasSubstr("ended: interrupted"));
}

TEST(Haptics, PublishesPosesWithTheTube) {
    Running program(ETI_HAPTICS, with("simulated", {"--json", "--tool", "tube", "--duration", "2.5"}));
    EXPECT_EQ(program.wait(), 0) << program.err();
    EXPECT_GT(nlohmann::json::parse(program.out()).at("poses_published"), 40);
}

TEST(Haptics, InvalidSilenceLimitIsRefused) {
    for (const char* silence : {"nan", "19", "1001", "-300", "long"}) {
        const Done done = run(ETI_HAPTICS, with("simulated", {"--silence-ms", silence, "--duration", "1"}));
        EXPECT_GT(done.status, 0) << silence;
        EXPECT_THAT(done.err, AllOf(HasSubstr("--silence-ms"), HasSubstr(silence)));
    }
}

TEST(Haptics, MissingVendorLibraryIsNamed) {
    const Done done =
        run(ETI_HAPTICS, with("openhaptics", {"--uncalibrated", "--library", "/nowhere/libHD.so"}));
    EXPECT_GT(done.status, 0);
    EXPECT_THAT(done.err, AllOf(HasSubstr("/nowhere/libHD.so"), HasSubstr("Install OpenHaptics")));
}

}  // namespace
}  // namespace eti::devices
