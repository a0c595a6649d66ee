// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/app/window/command_keys.hpp"
#include "client/app/window/compositor.hpp"
#include "client/app/window/window.hpp"
#include "client/app/window/windowed.hpp"
#include "common/process/stop_signal.hpp"
#include "synthetic_server.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/eventually.hpp"
#include "tests/support/virtual_display.hpp"

namespace eti {
namespace {

class WindowTest : public ::testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(display_.ready()) << "Xvfb does not start; install the package xvfb";
        window_.emplace(320, 240, "test");
        native_ = glfwGetCurrentContext();
    }

    test::VirtualDisplay display_;
    std::optional<client::Window> window_;
    GLFWwindow* native_ = nullptr;
};

TEST(Window, ErrorWithoutDisplaySuggestsOffscreen) {
    ::unsetenv("DISPLAY");
    ::unsetenv("WAYLAND_DISPLAY");
    EXPECT_THAT(test::error_of<std::runtime_error>([&] { const client::Window window(320, 240, "test"); }),
                ::testing::HasSubstr("--offscreen"));
}

TEST(Window, ShowsDrawnScene) {
    const test::VirtualDisplay display;
    ASSERT_TRUE(display.ready()) << "Xvfb does not start; install the package xvfb";
    client::Window window(320, 240, "test");
    view::SceneView scene;
    synthetic::fill(scene, synthetic::make_scene());
    client::Compositor compositor(window.width(), window.height(), render::qualities().front());
    compositor.draw(client::default_selection().views(scene), scene, hud::make_readout(scene, false), {},
                    false);
    compositor.target().copy_to(0, {0, 0, 320, 240}, {0, 0, 320, 240});
    // The next frame of the window, read back from the window itself.
    std::vector<std::uint8_t> shown(4 * 320 * 240);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    glReadBuffer(GL_BACK);
    glReadPixels(0, 0, 320, 240, GL_RGBA, GL_UNSIGNED_BYTE, shown.data());
    const render::Image drawn = compositor.target().read();
    std::set<std::array<std::uint8_t, 3>> colours;
    for (int y = 0; y < 240; ++y) {
        for (int x = 0; x < 320; ++x) {
            const std::uint8_t* const in_window = shown.data() + 4 * ((239 - y) * 320 + x);
            const std::uint8_t* const in_picture = drawn.pixel(x, y);
            colours.insert({in_window[0], in_window[1], in_window[2]});
            ASSERT_EQ(in_window[0], in_picture[0]) << x << ", " << y;
            ASSERT_EQ(in_window[1], in_picture[1]) << x << ", " << y;
            ASSERT_EQ(in_window[2], in_picture[2]) << x << ", " << y;
        }
    }
    EXPECT_GT(colours.size(), 500u);
    window.swap_buffers();
    window.poll_events();
    EXPECT_TRUE(window.open());
}

TEST(Window, QueuesKeysUntilTaken) {
    const test::VirtualDisplay display;
    ASSERT_TRUE(display.ready()) << "Xvfb does not start; install the package xvfb";
    client::Window window(320, 240, "test");
    // As called by the window system.
    GLFWwindow* const native = glfwGetCurrentContext();
    const GLFWkeyfun on_key = glfwSetKeyCallback(native, nullptr);
    const GLFWcharfun on_character = glfwSetCharCallback(native, nullptr);
    on_key(native, GLFW_KEY_UP, 0, GLFW_PRESS, 0);
    on_key(native, GLFW_KEY_UP, 0, GLFW_REPEAT, 0);
    on_key(native, GLFW_KEY_UP, 0, GLFW_RELEASE, 0);
    on_key(native, GLFW_KEY_S, glfwGetKeyScancode(GLFW_KEY_S), GLFW_PRESS, 0);
    on_character(native, U'S');
    on_key(native, GLFW_KEY_S, glfwGetKeyScancode(GLFW_KEY_S), GLFW_RELEASE, 0);
    const std::vector<client::KeyEvent> keys = window.take_keys();
    ASSERT_EQ(keys.size(), 5u);
    EXPECT_TRUE(keys[0].key == client::key_up && keys[0].down && !keys[0].repeated);
    EXPECT_TRUE(keys[1].key == client::key_up && keys[1].down && keys[1].repeated);
    EXPECT_TRUE(keys[2].key == client::key_up && !keys[2].down);
    EXPECT_TRUE(keys[3].key == U's' && keys[3].down && !keys[3].repeated);
    EXPECT_TRUE(keys[4].key == U's' && !keys[4].down);
    EXPECT_TRUE(window.take_keys().empty());
    on_key(native, GLFW_KEY_ESCAPE, 0, GLFW_PRESS, 0);
    EXPECT_FALSE(window.open());
}

// As a window system calls with the Russian and the French layout.
TEST_F(WindowTest, KeysWithoutTheirLetterActByPosition) {
    const GLFWkeyfun on_key = glfwSetKeyCallback(native_, nullptr);
    const GLFWcharfun on_character = glfwSetCharCallback(native_, nullptr);
    const auto type = [&](int position, unsigned character) {
        on_key(native_, position, 0, GLFW_PRESS, 0);
        on_character(native_, character);
        on_key(native_, position, 0, GLFW_RELEASE, 0);
        return window_->take_keys();
    };
    struct Row {
        int position;
        unsigned character;
        char32_t key;
    };
    for (const Row& row :
         {Row{GLFW_KEY_S, U'\u044b', U's'}, Row{GLFW_KEY_P, U'\u0417', U'p'},
          Row{GLFW_KEY_LEFT_BRACKET, U'\u0445', U'['}, Row{GLFW_KEY_1, U'&', U'1'},
          // The letter counts where the layout has it: z on a German keyboard, - on a French one.
          Row{GLFW_KEY_Y, U'z', U'z'}, Row{GLFW_KEY_6, U'-', U'-'}}) {
        const std::vector<client::KeyEvent> keys = type(row.position, row.character);
        ASSERT_EQ(keys.size(), 2u) << row.position;
        EXPECT_TRUE(keys[0].key == row.key && keys[0].down && keys[0].typed == row.character) << row.position;
        EXPECT_TRUE(keys[1].key == row.key && !keys[1].down) << row.position;
    }
}

TEST_F(WindowTest, QueuesDragsUntilTaken) {
    const GLFWcursorposfun on_move = glfwSetCursorPosCallback(native_, nullptr);
    const GLFWmousebuttonfun on_button = glfwSetMouseButtonCallback(native_, nullptr);
    const GLFWscrollfun on_wheel = glfwSetScrollCallback(native_, nullptr);
    on_move(native_, 100.0, 50.0);  // no button is held
    on_button(native_, GLFW_MOUSE_BUTTON_RIGHT, GLFW_PRESS, 0);
    on_move(native_, 110.0, 45.0);
    on_move(native_, 112.0, 45.0);
    on_button(native_, GLFW_MOUSE_BUTTON_RIGHT, GLFW_RELEASE, 0);
    on_move(native_, 0.0, 0.0);
    on_wheel(native_, 0.0, -2.0);
    const std::vector<hands::Drag> drags = window_->take_drags();
    ASSERT_EQ(drags.size(), 3u);
    EXPECT_TRUE(drags[0].from_x == 100.0f && drags[0].from_y == 50.0f && drags[0].right_button);
    EXPECT_TRUE(drags[0].x == 10.0f && drags[0].y == -5.0f && drags[0].notches == 0.0f);
    EXPECT_TRUE(drags[1].from_x == 100.0f && drags[1].x == 2.0f && drags[1].y == 0.0f);
    EXPECT_TRUE(drags[2].from_x == 0.0f && drags[2].x == 0.0f && drags[2].notches == -2.0f);
    EXPECT_TRUE(window_->take_drags().empty());
}

TEST_F(WindowTest, ShiftDragDrawsMark) {
    const GLFWcursorposfun on_move = glfwSetCursorPosCallback(native_, nullptr);
    const GLFWmousebuttonfun on_button = glfwSetMouseButtonCallback(native_, nullptr);
    on_move(native_, 100.0, 50.0);
    on_button(native_, GLFW_MOUSE_BUTTON_LEFT, GLFW_PRESS, GLFW_MOD_SHIFT);
    on_move(native_, 110.0, 45.0);
    on_button(native_, GLFW_MOUSE_BUTTON_LEFT, GLFW_RELEASE, 0);
    on_move(native_, 0.0, 0.0);
    using Mark = hands::Drag::Mark;
    const std::vector<hands::Drag> drags = window_->take_drags();
    ASSERT_EQ(drags.size(), 3u);
    EXPECT_TRUE(drags[0].mark == Mark::begins && drags[0].at_x == 100.0f && drags[0].at_y == 50.0f);
    EXPECT_TRUE(drags[1].mark == Mark::continues && drags[1].at_x == 110.0f && drags[1].from_x == 100.0f);
    EXPECT_TRUE(drags[2].mark == Mark::ends && drags[2].at_x == 110.0f && drags[2].at_y == 45.0f);
}

TEST_F(WindowTest, EscapeEndsTextInputNotProgram) {
    const GLFWkeyfun on_key = glfwSetKeyCallback(native_, nullptr);
    window_->intercept_escape(true);
    on_key(native_, GLFW_KEY_ESCAPE, 0, GLFW_PRESS, 0);
    EXPECT_TRUE(window_->open());
    const std::vector<client::KeyEvent> keys = window_->take_keys();
    ASSERT_EQ(keys.size(), 1u);
    EXPECT_EQ(keys[0].key, client::key_escape);
    window_->intercept_escape(false);
    on_key(native_, GLFW_KEY_ESCAPE, 0, GLFW_PRESS, 0);
    EXPECT_FALSE(window_->open());
}

TEST_F(WindowTest, MinimalSizeIsDrawnAndGrowsBack) {
    view::SceneView scene;
    synthetic::fill(scene, synthetic::make_scene());
    client::Compositor compositor(window_->width(), window_->height(), render::qualities().front());
    const client::Selection& four = client::instructor_selection();
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 400}, {400, 2}, {320, 240}}) {
        glfwSetWindowSize(native_, width, height);
        ASSERT_TRUE(test::eventually([&] {
            window_->poll_events();
            return window_->width() == std::max(width, 64) && window_->height() == std::max(height, 64);
        })) << window_->width()
            << " x " << window_->height();
        compositor.resize(window_->width(), window_->height());
        compositor.draw(four.plain, scene, hud::make_readout(scene, false), {}, false, four.arrangement);
        const render::Viewport whole{0, 0, window_->width(), window_->height()};
        compositor.target().copy_to(0, whole, whole);
        window_->swap_buffers();
    }
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST(Window, GivesUpAfterWaitTimeWithoutServer) {
    const test::VirtualDisplay display;
    ASSERT_TRUE(display.ready()) << "Xvfb does not start; install the package xvfb";
    request_stop(false);
    client::Options options;
    options.bus = synthetic::bus_options("eti-client");
    options.width = 320;
    options.height = 240;
    options.wait_s = 0.5;
    nlohmann::json result;
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_THAT(test::error_of<bus::BusError>([&] { (void)client::run_windowed(options, result); }),
                ::testing::HasSubstr("no server found for 0.5 s (--wait)"));
    EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(500));
}

TEST(Window, FollowsSessionOverBus) {
    const test::VirtualDisplay display;
    ASSERT_TRUE(display.ready()) << "Xvfb does not start; install the package xvfb";
    request_stop(false);
    synthetic::SyntheticServer server(1e9);
    client::Options options;
    options.bus = synthetic::bus_options("eti-client");
    options.width = 320;
    options.height = 240;
    options.frames = 5;
    nlohmann::json result;
    EXPECT_EQ(client::run_windowed(options, result), 0);
    EXPECT_EQ(result["frames"], 5);
    EXPECT_EQ(result["messages_dropped"], 0);
    EXPECT_GT(result["simulation_time_s"].get<double>(), 0.0);
}

}  // namespace
}  // namespace eti
