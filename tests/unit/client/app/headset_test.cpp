// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors

// A scripted headset, from OpenXR's loader through its validation layer to a server on the bus.
#include "client/app/headset/headset.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include <nlohmann/json.hpp>

#include "client/app/headset/headset_panel.hpp"
#include "client/render/gl/headless_context.hpp"
#include "client/render/image.hpp"
#include "client/view/sight/airway_axes.hpp"
#include "common/process/stop_signal.hpp"
#include "synthetic_server.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/support/virtual_display.hpp"

namespace eti {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using synthetic::SyntheticServer;

constexpr const char* right_trigger = "/user/hand/right/input/trigger/value";

json pictures_of_frames() {
    json frames = json::array();
    for (int frame = 10; frame < 20000; frame += 10) {
        frames.push_back(frame);
    }
    return frames;
}

class HeadsetTest : public test::ScratchFolderTest {
  protected:
    enum class Screen { window, none };

    explicit HeadsetTest(Screen screen = Screen::window) {
        request_stop(false);
        ::setenv("ETI_HEADSET_FOLDER", folder.c_str(), 1);
        ::setenv("XR_RUNTIME_JSON", ETI_HEADSET_RUNTIME, 1);
        options_.bus = synthetic::bus_options("eti-client");
        options_.headset = true;
        options_.width = options_.height = 128;
        options_.quality = &render::qualities().front();
        if (screen == Screen::window) {
            display_.emplace();
            // Debian's version knows GLX, and rejects the EGL structure as unknown.
            ::setenv("XR_ENABLE_API_LAYERS", "XR_APILAYER_LUNARG_core_validation", 1);
            ::setenv("XR_CORE_VALIDATION_EXPORT_TYPE", "text", 1);
            ::setenv("XR_CORE_VALIDATION_FILE_NAME", (folder / "validation.txt").c_str(), 1);
        } else {
            ::unsetenv("DISPLAY");
            ::unsetenv("XR_ENABLE_API_LAYERS");
        }
    }
    ~HeadsetTest() override { request_stop(false); }

    // Runs the client until the script or `enough` ends it, for a minute at most.
    int wear(
        json script, const std::function<bool()>& enough = [] { return false; }) {
        if (display_ && !display_->ready()) {
            ADD_FAILURE() << "Xvfb does not start; install the package xvfb";
            return -1;
        }
        script["eye_width"] = script["eye_height"] = side;
        script["pace_ms"] = script.value("pace_ms", 4);
        std::ofstream(folder / "script.json") << script;
        std::atomic<bool> done = false;
        std::thread watch([&] {
            const auto limit = std::chrono::steady_clock::now() + 60s;
            while (!done && !enough() && std::chrono::steady_clock::now() < limit) {
                std::this_thread::sleep_for(5ms);
            }
            request_stop(!done);
        });
        const int status = client::run_headset(options_, result_);
        done = true;
        watch.join();
        report_ = json::parse(std::ifstream(folder / "report.json"));
        return status;
    }
    // Every call was in order, every frame in time and from the eyes' pose at that time, and the validation
    // layer reported nothing.
    void expect_no_fault() const {
        EXPECT_EQ(report_["faults"], json::array());
        // From OpenXR 1.1 on the layer also says that it starts and ends, at its lowest level.
        std::ifstream file(folder / "validation.txt");
        std::string said;
        for (std::string line; std::getline(file, line);) {
            if (line.find("[VALID_DEBUG |") == std::string::npos) {
                said += line + '\n';
            }
        }
        EXPECT_EQ(said, "");
    }

    // A head that bends over the patient: report_["pictures"].back() holds what each eye saw last.
    void look_down() {
        ASSERT_EQ(wear({{"pictures", pictures_of_frames()},
                        {"head", {{{"position", {0, 0, 0}}, {"pitch", -0.6}}}}}),
                  0);
        expect_no_fault();
        ASSERT_FALSE(report_["pictures"].empty());
    }

    int side = 240;  // pixels
    std::optional<test::VirtualDisplay> display_;
    client::Options options_;
    json result_, report_;
};

class WindowlessHeadsetTest : public HeadsetTest {
  protected:
    WindowlessHeadsetTest() : HeadsetTest(Screen::none) {}
};

struct Extent {
    float left = 1e9f, right = -1e9f, top = 1e9f, bottom = -1e9f;
    void add(float x, float y) {
        left = std::min(left, x);
        right = std::max(right, x);
        top = std::min(top, y);
        bottom = std::max(bottom, y);
    }
};

// Pixels that are skin by their colour: nothing else in the room is as red.
Extent skin_in(const std::filesystem::path& picture) {
    const render::Image image = render::read_png(picture);
    Extent out;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const std::uint8_t* const p = image.pixel(x, y);
            // The lips' reflection on the blade's handle is redder; its height depends on the time of
            // drawing.
            if (p[0] > p[2] + 12 && 4 * (p[1] - p[2]) > p[0] - p[2]) {
                out.add(static_cast<float>(x), static_cast<float>(y));
                out.add(static_cast<float>(x + 1), static_cast<float>(y + 1));
            }
        }
    }
    return out;
}

// Expected pixel of a patient's point, from the eye's position, orientation and the four angles of its field
// alone. A point at (x, y, -z) in front of the eye is seen x / z to the right and y / z up. Pixels from the
// upper left.
Eigen::Vector2f pixel_by_mathematics(const json& eye, const Vec3f& gum, const Vec3f& point, int pixels) {
    const auto place = eye["position"].get<std::array<float, 3>>();
    const auto turn = eye["orientation"].get<std::array<float, 4>>();
    const auto field = eye["fov"].get<std::array<float, 4>>();
    const Eigen::Quaternionf rotation(turn[0], turn[1], turn[2], turn[3]);
    // Supine, head towards the trainee.
    const Vec3f world = gum + Vec3f(-point.x(), -point.y(), point.z());
    const Vec3f seen = rotation.conjugate() * (world - Vec3f(place[0], place[1], place[2]));
    const float x = seen.x() / -seen.z(), y = seen.y() / -seen.z();
    const float left = std::tan(field[0]), right = std::tan(field[1]);
    const float up = std::tan(field[2]), down = std::tan(field[3]);
    return Eigen::Vector2f((x - left) / (right - left), (up - y) / (up - down)) * static_cast<float>(pixels);
}

Extent skin_by_mathematics(const json& eye, const Vec3f& gum, int pixels) {
    Extent out;
    for (const Vec3f& point : synthetic::body_mesh().vertices) {
        const Eigen::Vector2f pixel = pixel_by_mathematics(eye, gum, point, pixels);
        out.add(pixel.x(), pixel.y());
    }
    return out;
}

// Centre of a dot drawn by the overlay in green: within 9 pixels of a point, because its text begins at 10.
Eigen::Vector2f green_dot_near(const std::filesystem::path& picture, const Eigen::Vector2f& place) {
    const render::Image image = render::read_png(picture);
    Extent out;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const Eigen::Vector2f here(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
            const std::uint8_t* const p = image.pixel(x, y);
            if ((here - place).norm() < 9.0f && p[1] > p[0] + 100 && p[1] > p[2] + 60) {
                out.add(static_cast<float>(x), static_cast<float>(y));
                out.add(static_cast<float>(x + 1), static_cast<float>(y + 1));
            }
        }
    }
    return {0.5f * (out.left + out.right), 0.5f * (out.top + out.bottom)};
}

void expect_close(const Extent& drawn, const Extent& expected, float pixels) {
    EXPECT_NEAR(drawn.left, expected.left, pixels);
    EXPECT_NEAR(drawn.right, expected.right, pixels);
    // The towel rises about the trunk's far end and hides some of it, never more than is there.
    EXPECT_GT(drawn.top, expected.top - pixels);
    EXPECT_LT(drawn.top, expected.top + 3.0f * pixels);
    EXPECT_NEAR(drawn.bottom, expected.bottom, pixels);
}

TEST_F(HeadsetTest, BothEyesMatchCameraProjection) {
    SyntheticServer server(1e9);
    options_.frames = 100;
    // Back and forth by 4 mm a frame: drawing from the eyes' present pose would be 4 pixels off, and be
    // reported.
    json head = json::array();
    for (int turn = 0; turn < 1000; ++turn) {
        const double aside = turn % 2 == 0 ? -0.04 : 0.04;
        head.push_back({{"frame", 20 * turn}, {"position", {aside, 0.02, 0.05}}, {"pitch", -0.6}});
    }
    ASSERT_EQ(wear({{"pictures", pictures_of_frames()}, {"head", head}}), 0);
    expect_no_fault();
    EXPECT_EQ(result_["end"], "enough frames");
    ASSERT_FALSE(report_["pictures"].empty());
    const json& last = report_["pictures"].back();
    std::array<Extent, 2> drawn, expected;
    for (std::size_t eye = 0; eye < 2; ++eye) {
        const auto file = fmt::format("{:03d}_{}.png", last["frame"].get<int>(), eye == 0 ? "left" : "right");
        drawn[eye] = skin_in(folder / file);
        expected[eye] = skin_by_mathematics(last["eyes"][eye], options_.gum_in_room, side);
        // Half a pixel of rasterisation, and one for a colour that fades along the rim.
        SCOPED_TRACE(file);
        expect_close(drawn[eye], expected[eye], 1.5f);
    }
    // 64 mm between eyes 0.4 m away.
    EXPECT_GT(expected[0].left - expected[1].left, 0.08f * static_cast<float>(side));
    EXPECT_NEAR(drawn[0].left - drawn[1].left, expected[0].left - expected[1].left, 1.5f);
}

TEST_F(HeadsetTest, PublishesDominantEye) {
    for (const bool left : {false, true}) {
        SyntheticServer server(1e9);
        options_.left_eye_dominant = left;
        options_.gum_in_room = {0.0f, -0.25f, -0.2f};
        std::filesystem::remove(folder / "report.json");
        ASSERT_EQ(wear({{"head", {{{"position", {0.01, 0.02, 0.03}}, {"pitch", -0.5}}}}},
                       [&] { return server.eyes() > 3; }),
                  0);
        expect_no_fault();
        request_stop(false);
        server.stop();
        // 0.01 m to the right of the middle and half of 64 mm to its side; 0.27 m above the gum and 0.23 m
        // behind it.
        const Vec3f expected(-(0.01f + (left ? -0.032f : 0.032f)), -0.27f, 0.23f);
        EXPECT_LT((server.eye() - expected).norm(), 1e-4f) << server.eye().transpose();
    }
}

// Input repeated until the server has received it, which may take long.
json again_and_again(std::initializer_list<std::pair<const char*, json>> inputs, int held, int every) {
    json out = json::array();
    for (int frame = every; frame < 20000; frame += every) {
        for (const auto& [input, value] : inputs) {
            out.push_back({{"frame", frame}, {"input", input}, {"value", value}});
            out.push_back({{"frame", frame + held}, {"input", input}, {"value", 0.0}});
        }
    }
    return out;
}

bool has(const std::vector<std::string>& commands, const std::string& one) {
    return std::ranges::find(commands, one) != commands.end();
}

TEST_F(HeadsetTest, ViveTriggerAndPadsSendCommands) {
    SyntheticServer server(1e9);
    const json hands = again_and_again({{right_trigger, 1.0},
                                        {"/user/hand/right/input/trackpad", json::array({0.1, 0.9})},
                                        {"/user/hand/right/input/trackpad/click", 1.0},
                                        {"/user/hand/left/input/trackpad", json::array({0.0, -0.8})},
                                        {"/user/hand/left/input/trackpad/click", 1.0}},
                                       10, 20);
    ASSERT_EQ(wear({{"hands", hands}},
                   [&] {
                       const auto all = server.commands();
                       return has(all, "suction 1.000") && has(all, "suction 0.000") &&
                              has(all, "head_elevation 0.017") && has(all, "table_angle -0.017");
                   }),
              0);
    expect_no_fault();
    server.stop();
    const auto commands = server.commands();
    EXPECT_TRUE(has(commands, "suction 1.000"));
    EXPECT_TRUE(has(commands, "suction 0.000"));
    EXPECT_TRUE(has(commands, "head_elevation 0.017")) << "a degree";
    EXPECT_TRUE(has(commands, "table_angle -0.017"));
    EXPECT_EQ(report_["profiles"], json({"/interaction_profiles/htc/vive_controller",
                                         "/interaction_profiles/khr/simple_controller"}));
}

// At the same depth as what they mark: each eye sees both in the same place.
TEST_F(HeadsetTest, MarksAlignWithTargetsInBothEyes) {
    RuntimeParameters marked;
    marked.view_gum_force = 1.0f;
    SyntheticServer server(1e9, 0, marked);
    options_.frames = 60;
    ASSERT_NO_FATAL_FAILURE(look_down());
    const json& last = report_["pictures"].back();
    const Vec3f gum = at(synthetic::make_scene().landmarks, Landmark::upper_gum);
    for (std::size_t eye = 0; eye < 2; ++eye) {
        const auto file = fmt::format("{:03d}_{}.png", last["frame"].get<int>(), eye == 0 ? "left" : "right");
        const Eigen::Vector2f there =
            pixel_by_mathematics(last["eyes"][eye], options_.gum_in_room, gum, side);
        EXPECT_LT((green_dot_near(folder / file, there) - there).norm(), 2.0f) << file;
    }
}

// Whether there is white, as wide as the line is drawn, within two pixels of a point.
bool white_near(const render::Image& image, const Eigen::Vector2f& place) {
    for (int y = static_cast<int>(place.y()) - 2; y <= static_cast<int>(place.y()) + 2; ++y) {
        for (int x = static_cast<int>(place.x()) - 2; x <= static_cast<int>(place.x()) + 2; ++x) {
            if (x >= 0 && y >= 0 && x < image.width && y < image.height) {
                const std::uint8_t* const p = image.pixel(x, y);
                if (p[0] > 215 && p[1] > 215 && p[2] > 215) {
                    return true;
                }
            }
        }
    }
    return false;
}

// Lines in space: each eye sees every point of them at its projection.
TEST_F(HeadsetTest, AirwayAxesMatchCameraProjectionInBothEyes) {
    RuntimeParameters shown;
    shown.view_axes = 1.0f;
    SyntheticServer server(1e9, 0, shown);
    options_.frames = 20;
    side = 480;  // names hide less of the lines
    ASSERT_NO_FATAL_FAILURE(look_down());
    const json& last = report_["pictures"].back();
    const synthetic::Scene source = synthetic::make_scene();
    const view::AirwayAxes axes = view::airway_axes(source.landmarks, shown.head_elevation);
    std::array<std::vector<Eigen::Vector2f>, 2> ends;
    for (std::size_t eye = 0; eye < 2; ++eye) {
        const auto file = fmt::format("{:03d}_{}.png", last["frame"].get<int>(), eye == 0 ? "left" : "right");
        const render::Image image = render::read_png(folder / file);
        int looked_at = 0;
        for (const view::AirwayAxis& axis : axes.axes) {
            for (const float along : {0.1f, 0.3f, 0.5f, 0.7f, 0.9f}) {
                const Vec3f point = axis.from + along * (axis.to - axis.from);
                const Eigen::Vector2f there =
                    pixel_by_mathematics(last["eyes"][eye], options_.gum_in_room, point, side);
                if ((there.array() < 2.0f).any() || (there.array() > static_cast<float>(side) - 2.0f).any()) {
                    continue;
                }
                ++looked_at;
                EXPECT_TRUE(white_near(image, there))
                    << file << ": " << axis.name << " at " << along << ", " << there.transpose();
            }
            ends[eye].push_back(pixel_by_mathematics(last["eyes"][eye], options_.gum_in_room, axis.to, side));
        }
        EXPECT_GE(looked_at, 10) << file;
    }
    for (std::size_t i = 0; i < axes.axes.size(); ++i) {
        EXPECT_GT(ends[0][i].x() - ends[1][i].x(), 0.05f * static_cast<float>(side))
            << "two eyes, two places";
    }
}

// Position in the room of a control of the panel, in the synthetic server's session.
Vec3f place_in_panel(std::string_view control) {
    const synthetic::Scene source = synthetic::make_scene();
    view::SceneView scene;
    synthetic::fill(scene, source);
    panel::Model model([](std::string_view, float) { return true; }, load_presets());
    panel::Model::Time now(100s);
    model.follow(scene, {}, now);
    const render::HeadlessContext context;
    const render::RenderTarget target(client::HeadsetPanel::width, client::HeadsetPanel::height, 1);
    panel::PanelRenderer drawing;
    target.bind_picture();
    for (int i = 0; i < 3; ++i) {
        drawing.draw_full_screen(model, target.width(), target.height(), now += 16ms);
    }
    const panel::Area area = drawing.place(control).value();
    const hmd::Quad panel = client::HeadsetPanel::place();
    // Near its right end.
    const float x = static_cast<float>(area.x + area.width) - 3.0f;
    const float y = static_cast<float>(area.y) + 0.5f * static_cast<float>(area.height);
    return panel.pose * Vec3f((x / static_cast<float>(target.width()) - 0.5f) * panel.width,
                              (0.5f - y / static_cast<float>(target.height())) * panel.height, 0.0f);
}

json aim_at(const Vec3f& from, const Vec3f& to) {
    const Quatf turn = Quatf::FromTwoVectors(-Vec3f::UnitZ(), to - from);
    return {{{"frame", 0},
             {"hand", "/user/hand/right"},
             {"position", {from.x(), from.y(), from.z()}},
             {"orientation", {turn.w(), turn.x(), turn.y(), turn.z()}}}};
}

TEST_F(HeadsetTest, LaserMovesPanelSlider) {
    const json aims = aim_at({0.2f, -0.3f, -0.1f}, place_in_panel("tongue_scale"));
    SyntheticServer server(1e9);
    options_.panel = true;
    int eyes_then = 0;
    ASSERT_EQ(wear({{"aims", aims},
                    {"pictures", pictures_of_frames()},
                    {"hands", again_and_again({{right_trigger, 1.0}}, 10, 20)}},
                   [&] {
                       if (eyes_then == 0 && has(server.commands(), "tongue_scale 1.400")) {
                           eyes_then = server.eyes();
                       }
                       return eyes_then > 0 && server.eyes() > eyes_then + 30;  // the answer arrived, too
                   }),
              0);
    expect_no_fault();
    server.stop();
    EXPECT_TRUE(has(server.commands(), "tongue_scale 1.400"));
    EXPECT_GE(result_["commands"]["accepted"], 1);
    EXPECT_FALSE(has(server.commands(), "suction 1.000")) << "a click on the panel sucks";
    const hmd::Quad place = client::HeadsetPanel::place();
    const auto hangs = report_["panel"]["position"].get<std::array<float, 3>>();
    EXPECT_LT((Vec3f(hangs[0], hangs[1], hangs[2]) - place.pose.translation).norm(), 1e-5f);
    EXPECT_EQ(report_["panel"]["size"][0], place.width);
    EXPECT_GT(place.pose.translation.norm(), 0.7f);
    EXPECT_LT(place.pose.translation.norm(), 1.5f);
}

TEST_F(HeadsetTest, ObserverPublishesNeitherEyeNorCommands) {
    SyntheticServer server(1e9);
    const json aims = aim_at({0.2f, -0.3f, -0.1f}, place_in_panel("tongue_scale"));
    options_.observe = options_.panel = true;
    options_.frames = 60;
    ASSERT_EQ(wear({{"aims", aims},
                    {"pictures", pictures_of_frames()},
                    {"hands", again_and_again({{right_trigger, 1.0}}, 5, 10)}}),
              0);
    EXPECT_TRUE(report_.contains("panel")) << "who only watches sees the panel";
    expect_no_fault();
    server.stop();
    EXPECT_EQ(server.eyes(), 0);
    EXPECT_TRUE(server.commands().empty());
    EXPECT_FALSE(result_.contains("commands"));
}

TEST_F(HeadsetTest, MenuButtonShowsPanel) {
    SyntheticServer server(1e9);
    options_.frames = 80;
    ASSERT_EQ(
        wear({{"pictures", pictures_of_frames()},
              {"hands", {{{"frame", 5}, {"input", "/user/hand/left/input/menu/click"}, {"value", 1.0}}}}}),
        0);
    expect_no_fault();
    EXPECT_TRUE(report_.contains("panel"));
    EXPECT_FALSE(has(server.commands(), "view_enhanced 1.000"));
}

TEST_F(HeadsetTest, SimpleControllerButtonsSendCommands) {
    SyntheticServer server(1e9);
    const json hands = again_and_again(
        {{"/user/hand/right/input/select/click", 1.0}, {"/user/hand/left/input/select/click", 1.0}}, 10, 20);
    ASSERT_EQ(wear({{"hands", hands}, {"controller", "/interaction_profiles/khr/simple_controller"}},
                   [&] {
                       const auto all = server.commands();
                       return has(all, "suction 1.000") && has(all, "head_elevation 0.017");
                   }),
              0);
    expect_no_fault();
    server.stop();
    EXPECT_TRUE(has(server.commands(), "suction 1.000"));
    EXPECT_TRUE(has(server.commands(), "head_elevation 0.017"));
}

TEST_F(HeadsetTest, SuctionStopsWhileMenuHasFocus) {
    SyntheticServer server(1e9);
    json events = json::array();
    for (int frame = 30; frame < 20000; frame += 60) {
        events.push_back({{"frame", frame}, {"what", "blur"}});
        events.push_back({{"frame", frame + 30}, {"what", "focus"}});
    }
    // The trigger is held all the time.
    const auto stops = [&] { return std::ranges::count(server.commands(), "suction 0.000"); };
    ASSERT_EQ(
        wear({{"hands", {{{"frame", 1}, {"input", right_trigger}, {"value", 1.0}}}}, {"events", events}},
             [&] { return stops() >= 2; }),
        0);
    expect_no_fault();
    EXPECT_GE(stops(), 2);
    EXPECT_GE(std::ranges::count(server.commands(), "suction 1.000"), 2);
}

TEST_F(HeadsetTest, HandlesEverySessionEvent) {
    const auto at = [](int frame, const char* what, int life = 0) {
        return json{{"frame", frame}, {"what", what}, {"life", life}};
    };
    ASSERT_EQ(wear({{"events",
                     {at(10, "blur"), at(15, "focus"), at(20, "hide"), at(30, "show"), at(40, "recentre"),
                      at(50, "sleep"), at(60, "lose_headset"), at(80, "lose_runtime"), at(20, "leave", 1)}}}),
              0);
    expect_no_fault();
    EXPECT_EQ(result_["end"], "left");
    EXPECT_EQ(result_["recentred"], 1);
    EXPECT_EQ(report_["lives"], 2) << "a runtime that went was waited for";
    EXPECT_EQ(report_["sessions"], 3) << "one to the headset's loss, one to the runtime's, one to the end";
    EXPECT_EQ(result_["sessions"], 3);
    // Frames continue while the session is not visible, but none is drawn.
    EXPECT_GE(report_["frames"].get<int>() - report_["shown"].get<int>(), 8);
}

TEST_F(HeadsetTest, WaitsForAbsentHeadset) {
    ASSERT_EQ(wear({{"absent", 2}, {"events", {{{"frame", 5}, {"what", "leave"}}}}}), 0);
    expect_no_fault();
    EXPECT_EQ(result_["end"], "left");
    EXPECT_EQ(report_["sessions"], 1);
}

TEST_F(HeadsetTest, CtrlCEndsTheWait) {
    const auto begun = std::chrono::steady_clock::now();
    ASSERT_EQ(wear({{"absent", 1000000}}, [&] { return std::chrono::steady_clock::now() - begun > 1s; }), 0);
    expect_no_fault();
    EXPECT_EQ(result_["end"], "stopped");
    EXPECT_EQ(report_["sessions"], 0);
}

TEST_F(HeadsetTest, CtrlCExitsRunningSessionCleanly) {
    SyntheticServer server(1e9);
    ASSERT_EQ(wear(json::object(), [&] { return server.eyes() > 3; }), 0);
    expect_no_fault();
    EXPECT_EQ(result_["end"], "stopped");
    EXPECT_GT(report_["shown"], 0);
}

TEST_F(HeadsetTest, RuntimeWithoutLayersGetsOneImagePerEye) {
    SyntheticServer server(1e9);
    options_.frames = 60;
    ASSERT_EQ(wear({{"layered", false},
                    {"pictures", pictures_of_frames()},
                    {"head", {{{"position", {0, 0, 0}}, {"pitch", -0.6}}}}}),
              0);
    expect_no_fault();
    EXPECT_EQ(result_["layered"], false);
    const json& last = report_["pictures"].back();
    for (std::size_t eye = 0; eye < 2; ++eye) {
        const auto file = fmt::format("{:03d}_{}.png", last["frame"].get<int>(), eye == 0 ? "left" : "right");
        SCOPED_TRACE(file);
        expect_close(skin_in(folder / file),
                     skin_by_mathematics(last["eyes"][eye], options_.gum_in_room, side), 1.5f);
    }
}

TEST_F(WindowlessHeadsetTest, DrawsWithoutDisplay) {
    SyntheticServer server(1e9);
    options_.frames = 20;
    ASSERT_EQ(wear({{"pictures", pictures_of_frames()}}), 0);
    expect_no_fault();
    EXPECT_GE(report_["shown"], 20);
    // The sheet hangs at a comfortable viewing distance: between 0.7 and 1.5 m.
    const auto place = report_["sheet"]["position"].get<std::array<float, 3>>();
    const auto turn = report_["sheet"]["orientation"].get<std::array<float, 4>>();
    const Vec3f sheet(place[0], place[1], place[2]);
    EXPECT_GT(sheet.norm(), 0.7f);
    EXPECT_LT(sheet.norm(), 1.5f);
    const Vec3f front = Eigen::Quaternionf(turn[0], turn[1], turn[2], turn[3]) * Vec3f::UnitZ();
    EXPECT_GT(front.dot(-sheet.normalized()), 0.999f) << "its front faces the eyes";
}

TEST_F(WindowlessHeadsetTest, ErrorWithoutRuntimeSaysWhatToInstall) {
    ::setenv("XR_RUNTIME_JSON", "/nowhere/runtime.json", 1);
    EXPECT_THAT(test::error_of<std::runtime_error>([&] { (void)client::run_headset(options_, result_); }),
                ::testing::AllOf(::testing::HasSubstr("--view hmd"), ::testing::HasSubstr("Install"),
                                 ::testing::HasSubstr("XR_RUNTIME_JSON")));
}

}  // namespace
}  // namespace eti
