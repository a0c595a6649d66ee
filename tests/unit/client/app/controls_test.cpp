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
    // Processes input until `enough`, or until the timeout.
    void follow(const std::function<bool()>& enough) {
        const auto limit = std::chrono::steady_clock::now() + 120s;
        while (!enough() && std::chrono::steady_clock::now() < limit) {
            input_.receive_into(scene_);
            controls_.update(now_);
            input_.wait(10ms);
        }
    }
    void press(char32_t key) { controls_.press(key, false, scene_, now_); }
    [[nodiscard]] std::string notice(const client::Controls& controls) const {
        hud::Readout readout;
        controls.add_to(readout, now_);
        return readout.notice;
    }

    bus::Node node_{synthetic::bus_options("eti-client")};
    client::SessionInput input_{node_, false, false};
    bus::CommandSender sender_{node_, "eti-client"};
    client::Controls controls_{client::default_selection(), &sender_};
    view::SceneView scene_;
    client::Controls::Time now_ = client::Controls::Time(100s);
};

TEST_F(ControlsTest, KeysReachServerAndRefusalsAreShown) {
    synthetic::SyntheticServer server(1e9);
    follow([&] { return scene_.metrics() && sender_.has_server(); });
    press(client::key_up);
    press(client::key_up);
    press(U'[');
    press(U's');
    controls_.release_all_keys(now_);
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

TEST_F(ControlsTest, EnhancedViewTogglesForAllClients) {
    synthetic::SyntheticServer server(1e9);
    follow([&] { return scene_.metrics() && sender_.has_server(); });
    EXPECT_EQ(controls_.selection().views(scene_).size(), 3u);
    press(U'e');
    follow([&] { return scene_.enhanced(); });
    ASSERT_EQ(controls_.selection().views(scene_).size(), 4u);
    EXPECT_EQ(controls_.selection().views(scene_).back()->name, "section");
    press(U'e');
    follow([&] { return !scene_.enhanced(); });
    EXPECT_EQ(controls_.selection().views(scene_).size(), 3u);
}

TEST_F(ControlsTest, IgnoresAnswersToOtherSenders) {
    synthetic::SyntheticServer server(1e9);
    bus::CommandSender other(node_, "another");
    follow([&] { return scene_.metrics() && sender_.has_server() && other.has_server(); });
    ASSERT_TRUE(other.send(server.refused, 1.0f));
    press(U'[');
    follow([&] { return sender_.accepted() == 1; });
    const auto limit = std::chrono::steady_clock::now() + 120s;
    while (other.refused() == 0 && std::chrono::steady_clock::now() < limit) {
        (void)other.take_answers();
        input_.wait(10ms);
    }
    EXPECT_EQ(other.refused(), 1u);
    EXPECT_EQ(sender_.refused(), 0u);
    EXPECT_EQ(notice(controls_), "");
}

TEST_F(ControlsTest, ObserverSendsNothing) {
    synthetic::SyntheticServer server(1e9);
    client::Controls observer(client::default_selection(), nullptr);
    follow([&] { return scene_.metrics() && sender_.has_server(); });
    for (const client::CommandKey& key : client::command_keys()) {
        observer.press(key.key, false, scene_, now_);
        observer.release(key.key, now_);
    }
    observer.release_all_keys(now_);
    EXPECT_EQ(notice(observer), "observers cannot send commands");
    // A later event proves that no earlier one came.
    press(U'[');
    follow([&] { return sender_.accepted() == 1; });
    EXPECT_EQ(server.commands(), Commands{"table_angle -0.017"});
}

TEST_F(ControlsTest, InstructorPointsDrawsAndWrites) {
    synthetic::fill(scene_, synthetic::make_scene());
    std::vector<msg::Annotation> sent;
    client::Annotator annotator("desk:7", [&](const msg::Annotation& one) {
        sent.push_back(one);
        return true;
    });
    client::Controls instructor(*client::selection_named("overview"), nullptr);
    instructor.set_annotator(annotator);
    constexpr int width = 640, height = 360;
    // Location of the tongue's patient: the upper gum, a little towards the forehead.
    const render::Camera camera = render::view_named("overview")->camera(scene_, {});
    const Vec3f forehead(0.0f, -0.005f, 0.05f);
    const Vec3f clip =
        (camera.projection(static_cast<float>(width) / height) * camera.view() * forehead.homogeneous())
            .eval()
            .hnormalized();
    hands::Drag mouse{.from_x = 0.5f * width * (1.0f + clip.x()),
                      .from_y = 0.5f * height * (1.0f - clip.y()),
                      .mark = hands::Drag::Mark::begins};
    mouse.at_x = mouse.from_x;
    mouse.at_y = mouse.from_y;
    const auto act = [&](hands::Drag::Mark what, float right) {
        mouse.mark = what;
        mouse.at_x += right;
        instructor.drag(mouse, scene_, width, height, now_);
    };
    act(hands::Drag::Mark::begins, 0.0f);
    instructor.follow(scene_);
    EXPECT_TRUE(instructor.vantage().sketch);
    act(hands::Drag::Mark::ends, 0.0f);
    ASSERT_EQ(sent.size(), 1u) << notice(instructor);
    EXPECT_EQ(sent[0].kind(), msg::ANNOTATION_POINT);
    EXPECT_EQ(sent[0].object().to_string(), "body");
    act(hands::Drag::Mark::begins, 0.0f);
    act(hands::Drag::Mark::continues, 2.0f);
    act(hands::Drag::Mark::continues, 6.0f);
    act(hands::Drag::Mark::ends, 0.0f);
    ASSERT_EQ(sent.size(), 2u);
    EXPECT_EQ(sent[1].kind(), msg::ANNOTATION_STROKE);
    EXPECT_EQ(sent[1].places().size(), 2u) << "a step of two pixels is none";
    instructor.press(U'w', false, scene_, now_);
    ASSERT_TRUE(instructor.writing());
    for (const char32_t c : {U's', U'o'}) {
        instructor.type(c, now_);
    }
    EXPECT_EQ(notice(instructor), "remark: so_");
    instructor.type(client::key_enter, now_);
    ASSERT_EQ(sent.size(), 3u);
    EXPECT_EQ(sent[2].text().to_string(), "so");
    instructor.press(U'z', false, scene_, now_);
    EXPECT_EQ(sent.at(3).kind(), msg::ANNOTATION_CLEAR);
    // An observer can do none of this.
    client::Controls observer(*client::selection_named("overview"), nullptr);
    mouse.mark = hands::Drag::Mark::begins;
    observer.drag(mouse, scene_, width, height, now_);
    observer.press(U'w', false, scene_, now_);
    EXPECT_FALSE(observer.writing());
    EXPECT_EQ(observer.vantage().orbit.azimuth, render::Vantage().orbit.azimuth);
}

TEST_F(ControlsTest, NonTraineeCanFollowTraineeEye) {
    const synthetic::Scene source = synthetic::make_scene();
    synthetic::fill(scene_, source);
    auto metrics = synthetic::metrics(source, 2'000'000, 40.0f);
    metrics.eye_heard(true);
    metrics.eye().position().z(0.3f);
    metrics.eye().orientation().w(1.0f);
    ASSERT_TRUE(scene_.apply(metrics));
    client::Controls instructor(client::instructor_selection(), nullptr);
    instructor.allow_trainee_view(true);
    instructor.follow(scene_);
    EXPECT_EQ(instructor.vantage().eye.position(scene_.landmarks()), Vec3f(0.0f, 0.0f, 0.3f));
    instructor.press(U't', false, scene_, now_);
    instructor.follow(scene_);
    EXPECT_EQ(instructor.vantage().eye.position(scene_.landmarks()), best_eye(scene_.landmarks()));
    // The trainee has one eye.
    controls_.press(U't', false, scene_, now_);
    controls_.follow(scene_);
    EXPECT_EQ(controls_.vantage().eye.position(scene_.landmarks()), best_eye(scene_.landmarks()));
}

TEST_F(ControlsTest, ReportsThatNoServerTakesCommands) {
    press(client::key_up);
    EXPECT_EQ(notice(controls_), "no server has reported its patient's state yet");
    synthetic::fill(scene_, synthetic::make_scene());
    press(client::key_up);
    EXPECT_EQ(notice(controls_), "no server accepts commands");
}

TEST_F(ControlsTest, SelectsViewsAndTogglesKeyHelp) {
    for (const client::Selection& one : client::selections()) {
        press(static_cast<char32_t>(one.key));
        EXPECT_EQ(&controls_.selection(), &one);
    }
    hud::Readout readout;
    controls_.add_to(readout, now_);
    EXPECT_TRUE(readout.keys.empty());
    press(U'h');
    controls_.add_to(readout, now_);
    EXPECT_EQ(readout.keys, client::keys_help(true));
    press(U'?');
    readout = {};
    controls_.add_to(readout, now_);
    EXPECT_TRUE(readout.keys.empty());
    // An observer has one key of its own: to the trainee's eye.
    EXPECT_EQ(client::keys_help(true).size() + 1,
              client::keys_help(false).size() + client::command_keys().size());
}

TEST(Options, HelpListsKeys) {
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
