// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fcntl.h>
#include <gmock/gmock.h>
#include <linux/joystick.h>
#include <pty.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "devices/sensor/device_error.hpp"
#include "devices/sensor/input/gamepad.hpp"
#include "devices/sensor/input/keyboard.hpp"
#include "tests/support/error_of.hpp"
#include "vendor_fixture.hpp"

namespace eti::devices {
namespace {

using ::testing::HasSubstr;

/// A named pipe stands in for the kernel's device file and delivers the same bytes.
class GamepadDriver : public ::testing::Test {
  protected:
    void SetUp() override {
        ASSERT_EQ(::mkfifo(file_.c_str(), 0600), 0);
        // Opened for both, so that opening does not block until the driver opens it.
        pad_ = ::open(file_.c_str(), O_RDWR | O_CLOEXEC);
        ASSERT_GE(pad_, 0);
    }
    void TearDown() override {
        ::close(pad_);
        ::unlink(file_.c_str());
    }
    void send(std::uint8_t type, std::uint8_t number, std::int16_t value) const {
        const js_event event{0, value, type, number};
        ASSERT_EQ(::write(pad_, &event, sizeof event), static_cast<ssize_t>(sizeof event));
    }
    SensorSetup setup() const {
        SensorSetup setup;
        setup.source = file_;
        return setup;
    }

    std::string file_ = testing::TempDir() + "eti_pad_" + std::to_string(::getpid());
    int pad_ = -1;
};

TEST_F(GamepadDriver, AxesAndButtonsComeThrough) {
    const auto device = open_gamepad(setup());
    Loop loop(*device);
    send(JS_EVENT_AXIS | JS_EVENT_INIT, 1, -32767);
    send(JS_EVENT_AXIS, 2, 16384);
    send(JS_EVENT_BUTTON, 0, 1);
    EXPECT_TRUE(loop.until([&] {
        return loop.reading.axes[1] == -1.0f && std::abs(loop.reading.axes[2] - 0.5f) < 1e-3f &&
               loop.reading.buttons == 1u;
    }));
    send(JS_EVENT_BUTTON, 0, 0);
    EXPECT_TRUE(loop.until([&] { return loop.reading.buttons == 0u; }));
}

TEST_F(GamepadDriver, OutOfRangeIndicesAreIgnored) {
    const auto device = open_gamepad(setup());
    Loop loop(*device);
    send(JS_EVENT_AXIS, 200, 32767);
    send(JS_EVENT_BUTTON, 77, 1);
    send(0x55, 0, 1);
    send(JS_EVENT_AXIS, 0, -32768);
    EXPECT_TRUE(loop.until([&] { return loop.reading.axes[0] == -1.0f; }));
    EXPECT_EQ(loop.reading.buttons, 0u);
}

TEST_F(GamepadDriver, ReconnectsAfterUnplugging) {
    const auto device = open_gamepad(setup());
    Loop loop(*device);
    send(JS_EVENT_AXIS, 0, 32767);
    ASSERT_TRUE(loop.until([&] { return loop.reading.axes[0] == 1.0f; }));
    ::close(pad_);
    ASSERT_EQ(::rename(file_.c_str(), (file_ + ".gone").c_str()), 0);
    ASSERT_TRUE(loop.until([&] { return !loop.reading.present && !device->fault().empty(); }));
    EXPECT_THAT(device->fault(), HasSubstr("Plug"));
    ASSERT_EQ(::rename((file_ + ".gone").c_str(), file_.c_str()), 0);
    pad_ = ::open(file_.c_str(), O_RDWR | O_CLOEXEC);
    EXPECT_TRUE(loop.until([&] { return loop.reading.present; }));
}

TEST(Gamepad, AMissingFileIsNamed) {
    SensorSetup setup;
    setup.source = "/nowhere/js0";
    EXPECT_THAT(test::error_of<DeviceError>([&] { (void)open_gamepad(setup); }), HasSubstr("/nowhere/js0"));
}

/// What a child with its own terminal received of the typed keys, as its exit status.
int typed(const std::string& keys, int (*seen)(Loop&)) {
    int terminal = -1;
    const pid_t child = ::forkpty(&terminal, nullptr, nullptr, nullptr);
    if (child == 0) {
        try {
            const auto device = open_keyboard({});
            Loop loop(*device);
            (void)::write(STDOUT_FILENO, "ready", 5);
            ::_exit(seen(loop));
        } catch (const DeviceError&) {
            ::_exit(99);
        }
    }
    std::array<char, 64> said{};
    (void)::read(terminal, said.data(), said.size());
    (void)::write(terminal, keys.data(), keys.size());
    int status = 0;
    ::waitpid(child, &status, 0);
    ::close(terminal);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(Keyboard, ArrowsDeflectFor100ms) {
    EXPECT_EQ(
        typed("\x1b[C\x1b[A",
              [](Loop& loop) {
                  if (!loop.until(
                          [&] { return loop.reading.axes[0] == 1.0f && loop.reading.axes[1] == -1.0f; })) {
                      return 1;
                  }
                  return loop.until(
                             [&] { return loop.reading.axes[0] == 0.0f && loop.reading.axes[1] == 0.0f; }, 1s)
                             ? 0
                             : 2;
              }),
        0);
}

TEST(Keyboard, STogglesSuctionAndBracketsTiltTheTable) {
    EXPECT_EQ(typed("s]",
                    [](Loop& loop) {
                        return loop.until([&] {
                            return loop.reading.buttons == 1u && loop.reading.axes[4] == -1.0f;
                        })
                                   ? 0
                                   : 1;
                    }),
              0);
}

TEST(Keyboard, LettersPressTheLarynx) {
    EXPECT_EQ(typed("bli",
                    [](Loop& loop) {
                        return loop.until([&] {
                            const auto& axes = loop.reading.axes;
                            return axes[3] == 1.0f && axes[6] == 1.0f && axes[7] == -1.0f;
                        })
                                   ? 0
                                   : 1;
                    }),
              0);
    EXPECT_EQ(typed("vjk",
                    [](Loop& loop) {
                        return loop.until([&] {
                            const auto& axes = loop.reading.axes;
                            return axes[3] == -1.0f && axes[6] == -1.0f && axes[7] == 1.0f;
                        })
                                   ? 0
                                   : 1;
                    }),
              0);
}

TEST(Keyboard, ClosedTerminalIsALostDevice) {
    int terminal = -1;
    const pid_t child = ::forkpty(&terminal, nullptr, nullptr, nullptr);
    if (child == 0) {
        ::signal(SIGHUP, SIG_IGN);
        const auto device = open_keyboard({});
        Loop loop(*device);
        (void)::write(STDOUT_FILENO, "ready", 5);
        ::_exit(loop.until([&] { return loop.watch.health().lost && !device->fault().empty(); }) ? 0 : 1);
    }
    std::array<char, 64> said{};
    ASSERT_GT(::read(terminal, said.data(), said.size()), 0);
    ::close(terminal);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

TEST(Keyboard, WithoutATerminalItIsRefused) {
    const int terminal = ::dup(STDIN_FILENO);
    const int nothing = ::open("/dev/null", O_RDONLY);
    ::dup2(nothing, STDIN_FILENO);
    EXPECT_THROW((void)open_keyboard({}), DeviceError);
    ::dup2(terminal, STDIN_FILENO);
    ::close(terminal);
    ::close(nothing);
}

}  // namespace
}  // namespace eti::devices
