// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hud/readout.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>

#include "client/hud/hud.hpp"
#include "client/render/gl/headless_context.hpp"
#include "client/render/gl/render_target.hpp"
#include "synthetic_scene.hpp"

namespace eti {
namespace {

TEST(Readout, ReflectsReceivedMessages) {
    const synthetic::Scene source = synthetic::make_scene();
    view::SceneView scene;
    EXPECT_EQ(hud::make_readout(scene, false).link, hud::ServerLink::waiting);
    synthetic::fill(scene, source);
    hud::Readout readout = hud::make_readout(scene, false);
    EXPECT_EQ(readout.link, hud::ServerLink::running);
    EXPECT_FLOAT_EQ(readout.measures.glottic_opening_percent, 40.0f);
    EXPECT_FLOAT_EQ(readout.measures.gum_force_n, 1.5f);
    EXPECT_FLOAT_EQ(readout.measures.tube_force_n, 0.25f);
    EXPECT_DOUBLE_EQ(readout.time_s, 1e-3);
    EXPECT_EQ(readout.attempt, 1u);
    // The blade's tip lies in the vallecula; marching tetrahedra of 2 mm round the tip by up to 1 mm.
    const float expected =
        100.0f *
        (at(source.landmarks, Landmark::vallecula) - at(source.landmarks, Landmark::upper_gum)).norm();
    EXPECT_NEAR(readout.blade_depth_cm, expected, 0.1f);
    EXPECT_EQ(hud::make_readout(scene, true).link, hud::ServerLink::lost);
    scene.apply(synthetic::status(msg::PHASE_FINISHED));
    EXPECT_EQ(hud::make_readout(scene, true).link, hud::ServerLink::finished);
}

TEST(Readout, ShowsVitalSignsOnlyIfSimulated) {
    const synthetic::Scene source = synthetic::make_scene();
    view::SceneView scene;
    synthetic::fill(scene, source);
    EXPECT_FALSE(hud::make_readout(scene, false).vital_signs);
    msg::LiveMetrics live = synthetic::metrics(source, 2'000'000, 40.0f);
    AttemptMetrics parameters = initial_metrics();
    parameters.oxygen_saturation_end_percent = 78.5;
    parameters.heart_rate_end_per_min = 96.0;
    live.parameters(bus::to_msg(parameters));
    ASSERT_TRUE(scene.apply(live));
    const auto signs = hud::make_readout(scene, false).vital_signs;
    ASSERT_TRUE(signs);
    EXPECT_DOUBLE_EQ(signs->oxygen_saturation_percent, 78.5);
    EXPECT_DOUBLE_EQ(signs->heart_rate_per_min, 96.0);
    EXPECT_EQ(hud::level_of(&LiveMeasures::oxygen_saturation_percent, 78.5), hud::Level::bad);
    EXPECT_EQ(hud::level_of(&LiveMeasures::heart_rate_per_min, 96.0), hud::Level::warning);
    EXPECT_EQ(hud::level_of(&LiveMeasures::oxygen_saturation_percent, 97.0), hud::Level::good);
}

TEST(Readout, ShowsOnlyEnabledAidsWithLevels) {
    const synthetic::Scene source = synthetic::make_scene();
    view::SceneView scene;
    synthetic::fill(scene, source);
    const auto readout = [&](const RuntimeParameters& aids, double time, double depth, msg::TubePlace place,
                             float gum) {
        msg::LiveMetrics live = synthetic::metrics(source, 2'000'000, 40.0f);
        bus::set_runtime_parameters(aids, live);
        AttemptMetrics parameters = initial_metrics();
        parameters.time_s = time;
        parameters.tube_depth_at_lip_cm = depth;
        parameters.tube_depth_rule_cm = 9.5;
        live.parameters(bus::to_msg(parameters));
        live.tube_place(place);
        synthetic::set(live, &LiveMeasures::gum_force_n, gum);
        EXPECT_TRUE(scene.apply(live));
        return hud::make_readout(scene, false);
    };
    const hud::Readout plain = readout({}, 31.0, 12.0, msg::TUBE_IN_OESOPHAGUS, 9.0f);
    EXPECT_FALSE(plain.clock);
    EXPECT_FALSE(plain.tube_depth);
    EXPECT_TRUE(plain.alarms.empty());
    RuntimeParameters aids;
    aids.view_clock = 1.0f;
    for (const auto& [time, level] :
         {std::pair{12.0, hud::Level::good}, {20.5, hud::Level::warning}, {30.1, hud::Level::bad}}) {
        const auto clock = readout(aids, time, 9.5, msg::TUBE_IN_MOUTH, 0.0f).clock;
        ASSERT_TRUE(clock);
        EXPECT_EQ(clock->limit_s, 30.0);
        EXPECT_EQ(clock->level(), level) << time;
    }
    aids = {};
    aids.view_tube_depth = 1.0f;
    for (const auto& [depth, level] :
         {std::pair{9.8, hud::Level::good}, {8.8, hud::Level::warning}, {10.6, hud::Level::bad}}) {
        EXPECT_EQ(readout(aids, 5.0, depth, msg::TUBE_IN_TRACHEA, 0.0f).tube_depth->level(), level) << depth;
    }
    aids = {};
    aids.view_enhanced = 1.0f;
    const auto alarms = [&](double depth, msg::TubePlace place, float gum) {
        return readout(aids, 5.0, depth, place, gum).alarms;
    };
    using Words = std::vector<std::string>;
    EXPECT_EQ(alarms(9.5, msg::TUBE_IN_TRACHEA, 1.0f), Words{});
    EXPECT_EQ(alarms(9.5, msg::TUBE_IN_OESOPHAGUS, 5.0f),
              (Words{"pressing on the upper gum", "tube in the oesophagus"}));
    EXPECT_EQ(alarms(9.5, msg::TUBE_IN_MAIN_STEM, 1.0f), Words{"tube in a main bronchus"});
    EXPECT_EQ(alarms(10.6, msg::TUBE_IN_TRACHEA, 1.0f), Words{"tube too deep"});
}

TEST(Readout, BladeOutsideMouthHasZeroDepth) {
    const synthetic::Scene source = synthetic::make_scene();
    EXPECT_EQ(hud::blade_depth(source.landmarks, Vec3f(0.0f, -0.1f, 0.1f)), 0.0f);
}

TEST(Readout, AttemptVerdictExpiresAndRunVerdictStays) {
    const synthetic::Scene source = synthetic::make_scene();
    view::SceneView scene;
    synthetic::fill(scene, source);
    EXPECT_FALSE(hud::make_readout(scene, false).verdict);
    scene.apply(synthetic::summary(1, false, 2'000'000'000));
    scene.apply(synthetic::deformation(source, 3'000'000'000, 0.0f, 0.0f));
    const auto verdict = hud::make_readout(scene, false).verdict;
    ASSERT_TRUE(verdict);
    EXPECT_EQ(verdict->title, "attempt 1: no success");
    EXPECT_EQ(verdict->reason, "the tube lies in the oesophagus");
    ASSERT_EQ(verdict->numbers.size(), 5u);
    // Labels and units are the table's; each value is its index there.
    for (const auto& [label, value] : verdict->numbers) {
        const auto field = std::ranges::find(metric_fields, label, &MetricField::label);
        ASSERT_NE(field, metric_fields.end()) << label;
        EXPECT_EQ(value, std::to_string(field - metric_fields.begin()) + ".0 " + std::string(field->unit));
    }
    scene.apply(synthetic::deformation(source, 20'000'000'000, 0.0f, 0.0f));
    EXPECT_FALSE(hud::make_readout(scene, false).verdict) << "the attempt ended 18 s ago";
    scene.apply(synthetic::status(msg::PHASE_FINISHED));
    EXPECT_EQ(hud::make_readout(scene, false).verdict->title, "attempt 1: no success");
    scene.apply(synthetic::summary(0, true, 20'000'000'000));
    EXPECT_EQ(hud::make_readout(scene, false).verdict->title, "session: success");
}

TEST(Readout, ManikinAttemptOutcomeIsUnknown) {
    const synthetic::Scene source = synthetic::make_scene();
    view::SceneView scene;
    synthetic::fill(scene, source);
    AttemptMetrics parameters = initial_metrics();
    msg::LiveMetrics live = synthetic::metrics(source, 2'000'000, 0.0f);
    synthetic::set(live, &LiveMeasures::gum_force_n, 9.0f);
    live.parameters(bus::to_msg(parameters));
    ASSERT_TRUE(scene.apply(live));
    EXPECT_TRUE(hud::make_readout(scene, false).airway_measured);
    parameters = synthetic::manikin_metrics();
    live.parameters(bus::to_msg(parameters));
    ASSERT_TRUE(scene.apply(live));
    msg::AttemptSummary ended = synthetic::summary(1, false, 2'000'000'000);
    ended.reason("on a manikin nothing measures it");
    ended.parameters(bus::to_msg(parameters));
    ASSERT_TRUE(scene.apply(ended));
    const hud::Readout readout = hud::make_readout(scene, false);
    EXPECT_FALSE(readout.airway_measured);
    EXPECT_TRUE(readout.alarms.empty());
    ASSERT_TRUE(readout.verdict);
    EXPECT_EQ(readout.verdict->title, "attempt 1: outcome unknown");
    EXPECT_EQ(readout.verdict->level, hud::Level::neutral);
    EXPECT_EQ(readout.verdict->reason, "on a manikin nothing measures it");
}

TEST(Readout, NamesSilentDevice) {
    view::SceneView scene;
    synthetic::fill(scene, synthetic::make_scene());
    auto status = synthetic::status(msg::PHASE_RUNNING);
    status.laryngoscope(msg::DEVICE_HEARD);
    scene.apply(status);
    EXPECT_EQ(hud::make_readout(scene, false).warning, "");
    status.laryngoscope(msg::DEVICE_SILENT);
    scene.apply(status);
    EXPECT_EQ(hud::make_readout(scene, false).warning, "laryngoscope is silent");
    status.tube(msg::DEVICE_SILENT);
    status.phase(msg::PHASE_FROZEN);
    scene.apply(status);
    EXPECT_EQ(hud::make_readout(scene, false).warning, "laryngoscope and tube are silent: simulation paused");
    EXPECT_EQ(hud::make_readout(scene, false, true).warning, "two servers run this session: stop one");
}

TEST(Readout, ShowsScenarioWhileWaitingAndAtStart) {
    const synthetic::Scene source = synthetic::make_scene();
    view::SceneView scene;
    EXPECT_EQ(hud::make_readout(scene, false).description, "");
    scene.apply(source.description);
    EXPECT_EQ(hud::make_readout(scene, false).link, hud::ServerLink::waiting);
    EXPECT_EQ(hud::make_readout(scene, false).scenario, "synthetic");
    EXPECT_EQ(hud::make_readout(scene, false).description, "made by a test");
    synthetic::fill(scene, source);
    scene.apply(synthetic::deformation(source, 9'000'000'000, 0.0f, 0.0f));
    EXPECT_EQ(hud::make_readout(scene, false).description, "made by a test");
    scene.apply(synthetic::deformation(source, 11'000'000'000, 0.0f, 0.0f));
    EXPECT_EQ(hud::make_readout(scene, false).description, "");
}

TEST(Readout, ShowsDebriefingOnceFinished) {
    synthetic::Scene source = synthetic::make_scene();
    source.description.scenario_text("debriefing: was the view held?\n");
    view::SceneView scene;
    synthetic::fill(scene, source);
    EXPECT_EQ(hud::make_readout(scene, false).description, "made by a test");
    scene.apply(synthetic::status(msg::PHASE_FINISHED));
    EXPECT_EQ(hud::make_readout(scene, false).description, "was the view held?");
}

TEST(Hud, DrawsVerdictInGreenOrRed) {
    render::HeadlessContext context;
    render::RenderTarget target(640, 360, 1);
    hud::Hud overlay;
    const auto picture = [&](const std::optional<hud::Verdict>& verdict) {
        hud::Readout readout;
        readout.link = hud::ServerLink::running;
        readout.verdict = verdict;
        target.bind_picture();
        glClearColor(0, 0, 0, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        overlay.draw(readout, {}, 640, 360);
        return target.read();
    };
    const auto pixels = [](const render::Image& image, int channel) {
        int found = 0;
        for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
            const int other = channel == 0 ? 1 : 0;
            found += image.rgba[i + channel] > image.rgba[i + other] + 60 ? 1 : 0;
        }
        return found;
    };
    EXPECT_EQ(pixels(picture({}), 0) + pixels(picture({}), 1), 0);
    hud::Verdict verdict{
        "attempt 1: success", hud::Level::good, "the tube lies in the trachea", {{"time", "20.0 s"}}};
    EXPECT_GT(pixels(picture(verdict), 1), 200);
    verdict.level = hud::Level::bad;
    EXPECT_GT(pixels(picture(verdict), 0), 200);
    EXPECT_EQ(pixels(picture(verdict), 1), 0);
    verdict.level = hud::Level::neutral;  // neither, where it was not measured
    EXPECT_EQ(pixels(picture(verdict), 0) + pixels(picture(verdict), 1), 0);
}

TEST(Hud, UntitledTileRaisesNoGlError) {
    render::HeadlessContext context;
    render::RenderTarget target(640, 360, 1);
    hud::Hud overlay;
    target.bind_picture();
    const std::array tiles{hud::Tile{{}, 0, 0, 640, 360}};
    overlay.draw({}, tiles, 640, 360);
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST(Hud, DrawsHelpAndNoticesIfPresent) {
    render::HeadlessContext context;
    render::RenderTarget target(640, 360, 1);
    hud::Hud overlay;
    const auto lit_pixels = [&](const hud::Readout& readout) {
        target.bind_picture();
        glClearColor(0, 0, 0, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        overlay.draw(readout, {}, 640, 360);
        const render::Image image = target.read();
        int lit = 0;
        for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
            lit += image.rgba[i] > 120 ? 1 : 0;
        }
        return lit;
    };
    hud::Readout readout;
    readout.link = hud::ServerLink::running;
    EXPECT_EQ(lit_pixels(readout), 0);
    readout.notice = "refused: nothing has moved yet";
    const int noticed = lit_pixels(readout);
    // A letter of this font has some 15 lit pixels.
    EXPECT_GT(noticed, 10 * 26);
    readout.keys = {{"h ?", "this list"}, {"r", "tissue and tube back to rest"}};
    const int listed = lit_pixels(readout);
    EXPECT_GT(listed, 10 * 30);
    // The help stands alone.
    readout.guidance = {"2 of 5: blade in", "Drag with the left button"};
    EXPECT_EQ(lit_pixels(readout), listed);
    readout.keys.clear();
    EXPECT_GT(lit_pixels(readout), noticed + 10 * 30);
    // A line that fills the panel does not hide the following ones.
    readout.notice.clear();
    readout.guidance = {"title", std::string(40, 'M') + " MMMM"};
    const int two_lines = lit_pixels(readout);
    readout.guidance.emplace_back("MMMM");
    EXPECT_NEAR(lit_pixels(readout) - two_lines, two_lines / 11, two_lines / 44)
        << "one of eleven words of four";
}

TEST(Hud, DrawsNumbersAndBarGrowingWithForce) {
    render::HeadlessContext context;
    render::RenderTarget target(640, 360, 1);
    hud::Hud overlay;
    const hud::Tile tile{"overview", 0, 0, 640, 360};
    const auto coloured = [&](float force) {
        hud::Readout readout;
        readout.link = hud::ServerLink::running;
        readout.measures.gum_force_n = force;
        target.bind_picture();
        glClearColor(0, 0, 0, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        overlay.draw(readout, {&tile, 1}, 640, 360);
        const render::Image image = target.read();
        int longest = 0;  // row of coloured pixels, that is the bar
        for (int y = 0; y < image.height; ++y) {
            int row = 0;
            for (int x = 0; x < image.width; ++x) {
                const std::uint8_t* p = image.pixel(x, y);
                row += std::abs(p[0] - p[1]) > 60 ? 1 : 0;  // green, amber and red; text is grey
            }
            longest = std::max(longest, row);
        }
        return longest;
    };
    const int some = coloured(1.5f), more = coloured(3.0f), most = coloured(6.0f);
    // In proportion, but for the ticks at 2 and 4 N of 4 pixels each.
    EXPECT_GT(some, 25);
    EXPECT_NEAR(more + 4, 2 * some, 3);
    EXPECT_NEAR(most + 8, 4 * some, 5);
}

}  // namespace
}  // namespace eti
