// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/offscreen/offscreen.hpp"

#include <gmock/gmock.h>

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "client/app/offscreen/pictures.hpp"
#include "common/process/stop_signal.hpp"
#include "synthetic_server.hpp"
#include "tests/support/error_of.hpp"

namespace eti {
namespace {

using namespace std::chrono_literals;

using synthetic::SyntheticServer;

class OffscreenTest : public ::testing::Test {
  protected:
    void SetUp() override {
        request_stop(false);
        options_.bus = synthetic::bus_options("eti-client");
        options_.offscreen =
            std::filesystem::temp_directory_path() / ("eti_offscreen_" + std::to_string(::getpid()));
        options_.video = options_.offscreen / "session.mp4";
        options_.width = 320;
        options_.height = 240;
        options_.picture_interval_s = 1.0;
    }
    void TearDown() override {
        std::filesystem::remove_all(options_.offscreen);
        request_stop(false);
    }

    [[nodiscard]] std::vector<std::string> pictures(const std::string& part) const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(options_.offscreen)) {
            const std::string name = entry.path().filename().string();
            if (name.find(part) != std::string::npos && entry.path().extension() == ".png") {
                names.push_back(name);
            }
        }
        return names;
    }

    [[nodiscard]] int video_frames() const {
        cv::VideoCapture video(options_.video.string());
        cv::Mat frame;
        int frames = 0;
        while (video.read(frame)) {
            ++frames;
        }
        return frames;
    }

    client::Options options_;
    nlohmann::json result_;
};

TEST_F(OffscreenTest, FollowsSessionToEnd) {
    SyntheticServer server(2.5);
    ASSERT_EQ(client::run_offscreen(options_, result_), 0);
    EXPECT_EQ(result_["end"], "finished");
    for (const char* name : {"laryngoscope", "overview", "auto"}) {
        EXPECT_EQ(pictures(std::string(name) + "_final").size(), 1u) << name;
    }
    EXPECT_TRUE(pictures("section").empty()) << "nobody asked for the enhanced view";
    ASSERT_EQ(pictures("laryngoscope_best").size(), 1u);
    // The full view lasts from 1 s on; a copy is taken whenever half a per cent more is seen.
    EXPECT_GE(pictures("laryngoscope_best").front(), "laryngoscope_best_000.990s.png");
    EXPECT_GE(result_["best_glottic_opening_percent"].get<double>(), 79.5);
    EXPECT_EQ(result_["messages_dropped"], 0);
    // Simulation time from the first picture to the end at 15 frames a second, including held frames, and one
    // second of the last picture.
    const int frames = video_frames();
    EXPECT_EQ(frames, result_["video"]["frames"].get<int>());
    const double seconds = result_["simulation_time_s"].get<double>();
    EXPECT_GT(seconds, 2.5);
    EXPECT_GE(frames, 15 + result_["frames"].get<int>());
    EXPECT_LE(frames, 15 + static_cast<int>(15 * seconds) + 1);
    const cv::Mat last = cv::imread((options_.offscreen / pictures("auto_final").front()).string());
    EXPECT_EQ(last.cols, 320);
    EXPECT_EQ(last.rows, 240);
}

TEST_F(OffscreenTest, TraineePublishesMovedEye) {
    SyntheticServer server(1.0, 4);
    options_.video.clear();
    options_.vantage.eye = view::TraineeEye(Vec3f(0.1f, 0.0f, 0.0f));
    ASSERT_EQ(client::run_offscreen(options_, result_), 0);
    server.stop();
    EXPECT_GE(server.eyes(), 4);
    // The best position lies in the middle, 0.3 m from the gum, outside, on the head's side.
    EXPECT_NEAR(server.eye().x(), 0.1f, 1e-3f);
    EXPECT_NEAR(server.eye().tail<2>().norm(), 0.3f, 0.03f);
    EXPECT_LT(server.eye().y(), 0.0f);
}

TEST_F(OffscreenTest, ObserverPublishesNothing) {
    SyntheticServer server(1.5);
    options_.observe = true;
    options_.selection = client::selection_named("section");
    ASSERT_EQ(client::run_offscreen(options_, result_), 0);
    server.stop();
    EXPECT_EQ(server.eyes(), 0);
    EXPECT_EQ(pictures("overview").size(), 0u);
    EXPECT_EQ(pictures("section_final").size(), 1u);
}

TEST_F(OffscreenTest, SkipsFramesThatAreNotSaved) {
    SyntheticServer server(1.5);
    options_.observe = true;
    options_.video.clear();
    options_.picture_interval_s = 0.0;
    options_.frames = 5;
    ASSERT_EQ(client::run_offscreen(options_, result_), 0);
    EXPECT_EQ(result_["frames"], 5);
    EXPECT_EQ(result_["frames_drawn"], 0);
    EXPECT_TRUE(result_["draw_ms"].empty());
    // The final pictures nevertheless show the newest shapes.
    EXPECT_EQ(pictures("overview_final").size(), 1u);
}

TEST_F(OffscreenTest, LostServerEndsRunWithFinalPictures) {
    auto server = std::make_unique<SyntheticServer>(1e9);
    std::thread killer([&] {
        while (server->time_s() < 1.5) {
            std::this_thread::sleep_for(10ms);
        }
        server->stop();
    });
    const int status = client::run_offscreen(options_, result_);
    killer.join();
    EXPECT_EQ(status, 0);
    EXPECT_EQ(result_["end"], "server lost");
    EXPECT_EQ(pictures("auto_final").size(), 1u);
    EXPECT_GT(video_frames(), 15);
}

TEST_F(OffscreenTest, FailsWithoutServer) {
    options_.wait_s = 0.3;
    options_.bus.session += "-nobody";
    EXPECT_NE(client::run_offscreen(options_, result_), 0);
    EXPECT_TRUE(result_.is_null());
}

TEST_F(OffscreenTest, StopsOnRequest) {
    SyntheticServer server(1e9);
    std::thread user([&] {
        while (server.eyes() < 2) {
            std::this_thread::sleep_for(10ms);
        }
        request_stop();
    });
    const int status = client::run_offscreen(options_, result_);
    user.join();
    EXPECT_EQ(status, 0);
    EXPECT_EQ(result_["end"], "stopped");
    EXPECT_GT(video_frames(), 0);
}

TEST_F(OffscreenTest, ErrorNamesFolderThatCannotBeCreated) {
    const auto file = std::filesystem::temp_directory_path() / ("eti_file_" + std::to_string(::getpid()));
    std::ofstream(file) << "not a folder";
    options_.offscreen = file / "pictures";
    EXPECT_THAT(test::error_of<std::runtime_error>([&] { (void)client::run_offscreen(options_, result_); }),
                ::testing::HasSubstr(options_.offscreen.string()));
    std::filesystem::remove(file);
}

TEST(PictureName, SortsByTimeAndNamesOccasion) {
    EXPECT_EQ(client::picture_name("section", "", 5.0), "section_005.000s.png");
    EXPECT_EQ(client::picture_name("section", "best", 31.25), "section_best_031.250s.png");
}

TEST(Layout, TilesCoverThePictureWithoutOverlap) {
    for (const client::Selection& selection : client::selections()) {
        for (const auto& [width, height] :
             {std::pair{960, 540}, std::pair{641, 479}, std::pair{64, 64}, std::pair{720, 1280}}) {
            // Each pixel belongs to one tile.
            std::vector<int> covered(static_cast<std::size_t>(width * height), 0);
            for (const auto& [view, tile] :
                 client::layout(selection.enhanced, width, height, selection.arrangement)) {
                ASSERT_GE(tile.x, 0);
                ASSERT_GE(tile.y, 0);
                ASSERT_LE(tile.x + tile.width, width);
                ASSERT_LE(tile.y + tile.height, height);
                for (int y = tile.y; y < tile.y + tile.height; ++y) {
                    for (int x = tile.x; x < tile.x + tile.width; ++x) {
                        ++covered[static_cast<std::size_t>(y * width + x)];
                    }
                }
            }
            EXPECT_EQ(std::ranges::count(covered, 1), width * height) << selection.name;
        }
    }
}

TEST(Layout, PortraitPlacesOtherTilesBelowFirst) {
    const auto tiles = client::layout(client::selection_named("auto")->enhanced, 720, 1280);
    ASSERT_EQ(tiles.size(), 4u);
    EXPECT_EQ(tiles[0].tile.width, 720);
    EXPECT_EQ(tiles[0].tile.height, 716);
    for (std::size_t i = 1; i < 4; ++i) {
        EXPECT_EQ(tiles[i].tile.y, 716);
        EXPECT_EQ(tiles[i].tile.width, 240);
    }
}

TEST(Layout, InstructorLayoutHasFourEqualTiles) {
    const client::Selection& four = client::instructor_selection();
    const auto tiles = client::layout(four.plain, 960, 540, four.arrangement);
    ASSERT_EQ(tiles.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(tiles[i].tile.width, 480);
        EXPECT_EQ(tiles[i].tile.height, 270);
        EXPECT_EQ(tiles[i].tile.x, i % 2 == 0 ? 0 : 480);
        EXPECT_EQ(tiles[i].tile.y, i < 2 ? 0 : 270);
    }
}

// A scene is complete before it has shapes: its frames arrive last.
TEST(Selections, ShowNothingWhileIncompleteOrMinimised) {
    const synthetic::Scene source = synthetic::make_scene();
    const client::Selection& all = *client::selection_named("all");
    view::SceneView scene;
    EXPECT_EQ(client::visible_views(all, scene, false), client::Views{});
    scene.apply(source.description);
    for (const auto& object : source.objects) {
        scene.apply(object);
    }
    ASSERT_TRUE(scene.complete());
    EXPECT_EQ(client::visible_views(all, scene, false), client::Views{});
    scene.apply(synthetic::deformation(source, 1'000'000, 0.0f, 0.0f));
    ASSERT_TRUE(scene.has_all_frames());
    EXPECT_EQ(client::visible_views(all, scene, false), all.plain);
    EXPECT_EQ(client::visible_views(all, scene, true), std::nullopt);
}

TEST(Selections, HaveUniqueNamesAndKeys) {
    std::set<std::string_view> names;
    std::set<char> keys;
    for (const client::Selection& one : client::selections()) {
        EXPECT_TRUE(names.insert(one.name).second) << one.name;
        EXPECT_TRUE(keys.insert(one.key).second) << one.name << " has another's key";
        EXPECT_FALSE(one.help.empty()) << one.name;
        EXPECT_EQ(client::selection_named(one.name), &one);
        EXPECT_EQ(client::selection_for_key(one.key), &one);
    }
    for (const render::View& view : render::views()) {
        EXPECT_TRUE(names.contains(view.name));
    }
}

}  // namespace
}  // namespace eti
