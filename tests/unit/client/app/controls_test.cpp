// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/controls.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "client/app/options.hpp"
#include "client/app/session_input.hpp"
#include "common/math/units.hpp"
#include "synthetic_server.hpp"

namespace eti {
namespace {

using namespace std::chrono_literals;
using Commands = std::vector<std::string>;

class ControlsTest : public ::testing::Test {
  protected:
    // Takes what comes until `enough` or for 10 s.
    void follow(const std::function<bool()>& enough) {
        const auto limit = std::chrono::steady_clock::now() + 10s;
        while (!enough() && std::chrono::steady_clock::now() < limit) {
            input_.take_into(scene_);
            controls_.tend(now_);
            input_.wait(10ms);
        }
    }
    void press(char32_t key) { controls_.press(key, false, scene_, now_); }
    [[nodiscard]] std::string notice(const client::Controls& controls) const {
        hud::Readout readout;
        controls.put_into(readout, now_);
        return readout.notice;
    }

    bus::Node node_{synthetic::bus_options("eti-client")};
    client::SessionInput input_{node_, false, false};
    bus::CommandSender sender_{node_, "eti-client"};
    client::Controls controls_{client::default_selection(), &sender_};
    view::SceneView scene_;
    client::Controls::Time now_ = client::Controls::Time(100s);
};

TEST_F(ControlsTest, TheTraineesKeysReachTheServerAndRefusalsTheScreen) {
    synthetic::SyntheticServer server(1e9);
    follow([&] { return scene_.metrics() && sender_.served(); });
    press(client::key_up);
    press(client::key_up);
    press(U'[');
    press(U's');
    controls_.let_go(now_);
    follow([&] { return sender_.accepted() == 5; });
    EXPECT_EQ(server.commands(), (Commands{"head_elevation 0.017", "head_elevation 0.035",
                                           "table_angle -0.017", "suction 1.000", "suction 0.000"}));
    EXPECT_EQ(sender_.accepted(), 5u);
    follow([&] { return scene_.live().table_angle != 0.0f; });
    EXPECT_NEAR(scene_.live().table_angle, -1.0f * degree, 1e-6f);
    EXPECT_EQ(notice(controls_), "");
    press(U'r');
    follow([&] { return sender_.refused() == 1; });
    EXPECT_EQ(notice(controls_), std::string("refused: ") + server.reason);
    now_ += 6s;
    EXPECT_EQ(notice(controls_), "");
}

TEST_F(ControlsTest, TheEnhancedViewGoesOnAndOffForAllWhoListen) {
    synthetic::SyntheticServer server(1e9);
    follow([&] { return scene_.metrics() && sender_.served(); });
    EXPECT_EQ(controls_.selection().views(scene_).size(), 3u);
    press(U'e');
    follow([&] { return scene_.enhanced(); });
    ASSERT_EQ(controls_.selection().views(scene_).size(), 4u);
    EXPECT_EQ(controls_.selection().views(scene_).back()->name, "section");
    press(U'e');
    follow([&] { return !scene_.enhanced(); });
    EXPECT_EQ(controls_.selection().views(scene_).size(), 3u);
}

TEST_F(ControlsTest, AnotherSendersAnswersAreNotTaken) {
    synthetic::SyntheticServer server(1e9);
    bus::CommandSender other(node_, "another");
    follow([&] { return scene_.metrics() && sender_.served() && other.served(); });
    ASSERT_TRUE(other.send(server.refused, 1.0f));
    press(U'[');
    follow([&] { return sender_.accepted() == 1; });
    const auto limit = std::chrono::steady_clock::now() + 10s;
    while (other.refused() == 0 && std::chrono::steady_clock::now() < limit) {
        (void)other.take_answers();
        input_.wait(10ms);
    }
    EXPECT_EQ(other.refused(), 1u);
    EXPECT_EQ(sender_.refused(), 0u);
    EXPECT_EQ(notice(controls_), "");
}

TEST_F(ControlsTest, AnObserverSendsNothing) {
    synthetic::SyntheticServer server(1e9);
    client::Controls observer(client::default_selection(), nullptr);
    follow([&] { return scene_.metrics() && sender_.served(); });
    for (const client::CommandKey& key : client::command_keys()) {
        observer.press(key.key, false, scene_, now_);
        observer.release(key.key, now_);
    }
    observer.let_go(now_);
    EXPECT_EQ(notice(observer), "an observer gives no commands");
    // What comes later shows that nothing came before.
    press(U'[');
    follow([&] { return sender_.accepted() == 1; });
    EXPECT_EQ(server.commands(), Commands{"table_angle -0.017"});
}

TEST_F(ControlsTest, SaysWhenNobodyTakesCommands) {
    press(client::key_up);
    EXPECT_EQ(notice(controls_), "no server has said yet how its patient is");
    synthetic::fill(scene_, synthetic::make_scene());
    press(client::key_up);
    EXPECT_EQ(notice(controls_), "no server takes commands");
}

TEST_F(ControlsTest, ChoosesViewsAndShowsTheKeys) {
    for (const client::Selection& one : client::selections()) {
        press(static_cast<char32_t>(one.key));
        EXPECT_EQ(&controls_.selection(), &one);
    }
    hud::Readout readout;
    controls_.put_into(readout, now_);
    EXPECT_TRUE(readout.keys.empty());
    press(U'h');
    controls_.put_into(readout, now_);
    EXPECT_EQ(readout.keys, client::keys_help(true));
    press(U'?');
    readout = {};
    controls_.put_into(readout, now_);
    EXPECT_TRUE(readout.keys.empty());
    EXPECT_EQ(client::keys_help(true).size(),
              client::keys_help(false).size() + client::command_keys().size());
}

TEST(Options, HelpSaysTheKeys) {
    client::Options options;
    char program[] = "eti-client", help[] = "--help";
    char* arguments[] = {program, help};
    ::testing::internal::CaptureStdout();
    EXPECT_EQ(client::parse(2, arguments, options), 0);
    const std::string said = ::testing::internal::GetCapturedStdout();
    for (const auto& [key, what] : client::keys_help(true)) {
        EXPECT_NE(said.find(what), std::string::npos) << key;
    }
}

}  // namespace
}  // namespace eti
