// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors

// What the client lays over its pictures: one table of name, view, session state and expected words. Text is
// read back from the overlay's draw lists; its contrast and the marks are measured in the picture. Pictures
// as wholes: the few in golden/.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "client/app/aids.hpp"
#include "client/app/controls.hpp"
#include "client/app/headset/eye_compositor.hpp"
#include "client/app/headset/headset_panel.hpp"
#include "client/app/window/compositor.hpp"
#include "client/hmd/room.hpp"
#include "client/hud/text_box.hpp"
#include "client/panel/panel_renderer.hpp"
#include "client/render/gl/headless_context.hpp"
#include "client/render/views/pick.hpp"
#include "client/text/catalogue.hpp"
#include "common/bus/security/session_keys.hpp"
#include "synthetic_scene.hpp"
#include "tests/support/drawn_text.hpp"
#include "tests/support/eventually.hpp"
#include "tests/support/golden.hpp"

namespace eti {
namespace {

using client::Selection;

constexpr std::uint64_t now_ns = 24'300'000'000;

// The session's state at one moment, for one picture.
class DrawnScene {
  public:
    /// `shapes`: all of `source` has been applied to it.
    DrawnScene(const synthetic::Scene& source, const view::SceneView& shapes)
        : scene(shapes), metrics(synthetic::metrics(source, now_ns, 40.0f)), source_(source) {
        scene.apply(synthetic::deformation(source, now_ns, 0.003f, 0.02f));
        scene.apply(synthetic::proxy(source, now_ns));
        synthetic::set(metrics, &LiveMeasures::gum_force_n, 1.0f);
        parameters.time_s = 24.3;
        parameters.tube_depth_at_lip_cm = 8.8;
        parameters.tube_depth_rule_cm = 9.5;
    }
    /// The blade presses on the upper gum, beside its middle.
    void press(float force) {
        synthetic::set(metrics, &LiveMeasures::gum_force_n, force);
        msg::ProxyState proxy = synthetic::proxy(source_, now_ns);
        const Vec3f where = at(scene.landmarks(), Landmark::upper_gum) + Vec3f(4e-3f, 0.0f, 0.0f);
        msg::ShellContact contact;
        contact.position(bus::to_msg(where));
        contact.force(force);
        contact.tissue(static_cast<std::uint32_t>(Tissue::upper_gum));
        proxy.contacts().push_back(contact);
        scene.apply(proxy);
    }
    void write(msg::AnnotationKind kind, const char* text, std::vector<msg::SurfacePlace> places = {}) {
        msg::ShownAnnotation one;
        one.header().simulation_time_ns(now_ns - 1'000'000'000);
        one.slot(static_cast<std::uint32_t>(scene.annotations().size()));
        one.what().kind(kind);
        one.what().text(text);
        one.what().object("body");
        one.what().places() = std::move(places);
        scene.apply(one);
    }
    /// A stroke on the forehead, with a word at its end.
    void draw_on_the_forehead() {
        const render::View& overview = *render::view_named("overview");
        std::vector<msg::SurfacePlace> places;
        for (int i = 0; i < 12; ++i) {
            const auto picked = render::pick(overview, scene, {}, 16.0f / 9.0f,
                                             0.05f + 0.0125f * static_cast<float>(i), -0.3f);
            if (picked && picked->object == "body") {
                msg::SurfacePlace& place = places.emplace_back();
                place.triangle(picked->place.triangle);
                place.u(picked->place.u);
                place.v(picked->place.v);
            }
        }
        ASSERT_GE(places.size(), 4u) << "the forehead is elsewhere";
        write(msg::ANNOTATION_POINT, "here", {places.back()});
        write(msg::ANNOTATION_STROKE, "", places);
    }
    void say() {
        bus::set_runtime_parameters(live, metrics);
        metrics.parameters(bus::to_msg(parameters));
        scene.apply(metrics);
        scene.apply(status);
        scene.update();
    }

    view::SceneView scene;
    RuntimeParameters live;
    msg::LiveMetrics metrics;
    AttemptMetrics parameters = initial_metrics();
    msg::SessionStatus status = synthetic::status(msg::PHASE_RUNNING);
    bool lost = false, contested = false;
    hud::Readout own;  ///< the client's own text: keys, notice, guidance

  private:
    const synthetic::Scene& source_;
};

struct Row {
    const char* name;
    const char* view;
    std::vector<std::string> words;
    void (*happens)(DrawnScene&);
    int width = 640, height = 360;  // of the window
    bool golden = false;
    bool panel = false;  // the instructor's, beside the scene

    [[nodiscard]] panel::Area scene_area() const {
        return panel ? panel::scene_area(width, height) : panel::Area{0, 0, width, height};
    }
};

void nothing(DrawnScene&) {}

void everything(DrawnScene& moment) {
    moment.live.view_enhanced = 1.0f;
    moment.metrics.tube_place(msg::TUBE_IN_OESOPHAGUS);
    moment.parameters.time_s = 31.7;
    moment.parameters.oxygen_saturation_end_percent = 78.0;
    moment.parameters.heart_rate_end_per_min = 96.0;
    moment.press(5.0f);
}

void lesson(DrawnScene& moment) {
    moment.live.view_enhanced = 1.0f;
    moment.write(msg::ANNOTATION_NOTE, "sweep the tongue aside");
    moment.draw_on_the_forehead();
}

const std::vector<Row>& table() {
    static const std::vector<Row> rows{
        {"overview", "overview", {"00:24.3", "gum force 1.0 N", "overview"}, nothing, 640, 360, true},
        {"eye", "eye", {"glottis seen 40 %", "tube force 0.25 N", "server 50 %"}, nothing, 640, 360, true},
        {"section",
         "section",
         {"attempt 1", "blade depth 5.1 cm", "tube before cords"},
         nothing,
         640,
         360,
         true},
        {"aids",
         "eye",
         {"31.7/30 s", "tube at the lip 8.8 cm", "by the rule 9.5 cm", "pressing on the upper gum",
          "tube in the oesophagus", "SpO2 % 78", "HR /min 96", "5.0 N", "blade"},
         everything},
        {"aids_in_section",
         "section",
         {"mouth", "throat, 84 deg", "larynx, 3 deg", "2.5 N", "blade"},
         [](DrawnScene& moment) {
             moment.live.view_enhanced = 1.0f;
             moment.press(2.5f);
         }},
        {"success",
         "eye",
         {"attempt 1: success", "the tube lies in the trachea"},
         [](DrawnScene& moment) { moment.scene.apply(synthetic::summary(1, true, now_ns - 1'000'000'000)); }},
        {"no_success",
         "eye",
         {"attempt 1: no success", "the tube lies in the oesophagus"},
         [](DrawnScene& moment) {
             moment.scene.apply(synthetic::summary(1, false, now_ns - 1'000'000'000));
         }},
        {"words",
         "overview",
         {"sweep the tongue aside", "here",
          "refused: secretion: there is no liquid in this scenario; restart it with 'saliva: standby'",
          "2 of 5: blade in",
          "Drag with the left button: the blade's tip follows, by the right corner of the mouth over the "
          "tongue."},
         [](DrawnScene& moment) {
             moment.write(msg::ANNOTATION_NOTE, "sweep the tongue aside");
             moment.draw_on_the_forehead();
             moment.own.notice =
                 "refused: secretion: there is no liquid in this scenario; restart it with 'saliva: standby'";
             moment.own.guidance = {"2 of 5: blade in",
                                    "Drag with the left button: the blade's tip follows, by the right corner "
                                    "of the mouth over the tongue."};
         }},
        {"keys",
         "eye",
         {"e enhanced view on or off", "r reset tissue and tube"},
         [](DrawnScene& moment) { moment.own.keys = client::keys_help(true, true); }},
        {"device_silent",
         "eye",
         {"laryngoscope and tube are silent: simulation paused"},
         [](DrawnScene& moment) {
             moment.status.laryngoscope(msg::DEVICE_SILENT);
             moment.status.tube(msg::DEVICE_SILENT);
             moment.status.phase(msg::PHASE_FROZEN);
         }},
        {"two_servers",
         "eye",
         {"two servers run this session: stop one"},
         [](DrawnScene& moment) { moment.contested = true; }},
        {"server_lost",
         "eye",
         {"server lost", "gum force 1.0 N"},
         [](DrawnScene& moment) { moment.lost = true; }},
        {"all_at_once",
         "auto",
         {"gum 5.0 N", "31.7/30 s", "tube at the lip 8.8 cm, by the rule 9.5", "SpO2 % 78",
          "tube in the oesophagus"},
         everything},
        {"upright",
         "auto",
         {"24.3/30 s", "2.5 N", "larynx, 3 deg"},
         [](DrawnScene& moment) {
             moment.live.view_enhanced = 1.0f;
             moment.press(2.5f);
         },
         360,
         640},
        {"four_small",
         "four",
         {"here", "throat, 84 deg"},
         [](DrawnScene& moment) {
             moment.live.view_enhanced = 1.0f;
             moment.draw_on_the_forehead();
         }},
        // In a newly opened window.
        {"trainee",
         "auto",
         {"24.3/30 s", "tube at the lip 8.8 cm"},
         [](DrawnScene& moment) { moment.live.view_enhanced = 1.0f; },
         960,
         540},
        {"instructor", "four", {"sweep the tongue aside", "here", "mouth"}, lesson, 960, 540, true, true},
    };
    return rows;
}

// Rounding differs between processors and moves edges: two thousand of 640 x 360 pixels lie at one.
constexpr double most_apart = 0.02;

class Overlay : public ::testing::TestWithParam<Row> {
  protected:
    static void SetUpTestSuite() {
        source_ = std::make_unique<synthetic::Scene>(synthetic::make_scene());
        source_->description.scenario("a_large_tongue_with_secretions, the second of three sessions");
        shapes_ = std::make_unique<view::SceneView>();
        synthetic::fill(*shapes_, *source_);
        context_ = std::make_unique<render::HeadlessContext>();
    }
    static void TearDownTestSuite() {
        compositor_.reset();
        context_.reset();
        shapes_.reset();
        source_.reset();
    }

    static client::Compositor& compositor() {
        if (!compositor_) {
            compositor_ = std::make_unique<client::Compositor>(640, 360, render::qualities().front());
        }
        return *compositor_;
    }
    /// Without the panel.
    static render::Image picture(const Row& row, DrawnScene& moment, const render::Vantage& from = {}) {
        row.happens(moment);
        moment.say();
        hud::Readout readout = hud::make_readout(moment.scene, moment.lost, moment.contested);
        readout.keys = moment.own.keys;
        readout.notice = moment.own.notice;
        readout.guidance = moment.own.guidance;
        const Selection& selection = *client::selection_named(row.view);
        const panel::Area area = row.scene_area();
        compositor().resize(area.width, area.height);
        compositor().draw(selection.views(moment.scene), moment.scene, readout, from, false,
                          selection.arrangement);
        return compositor().target().read();
    }
    static render::Image beside_panel(const render::Image& scene, const Row& row,
                                      const view::SceneView& says) {
        panel::Model model([](std::string_view, float) { return true; });
        panel::PanelRenderer drawing;
        panel::Model::Time now(std::chrono::seconds(100));
        model.follow(says, {}, now);
        const render::RenderTarget window(row.width, row.height, 1);
        window.bind_picture();
        for (int i = 0; i < 3; ++i) {  // until its lines have settled
            glClear(GL_COLOR_BUFFER_BIT);
            drawing.draw(model, row.width, row.height, now += std::chrono::milliseconds(16));
        }
        render::Image out = window.read();
        const panel::Area area = row.scene_area();
        for (int y = 0; y < area.height; ++y) {
            std::copy_n(
                scene.pixel(0, y), 4 * area.width,
                out.rgba.begin() + 4 * (static_cast<std::ptrdiff_t>(area.y + y) * out.width + area.x));
        }
        return out;
    }
    static std::filesystem::path golden(const std::string& name) {
        return std::filesystem::path(ETI_GOLDEN) / (name + ".png");
    }

    static std::unique_ptr<synthetic::Scene> source_;
    static std::unique_ptr<view::SceneView> shapes_;
    static std::unique_ptr<render::HeadlessContext> context_;
    static std::unique_ptr<client::Compositor> compositor_;
};
std::unique_ptr<synthetic::Scene> Overlay::source_;
std::unique_ptr<view::SceneView> Overlay::shapes_;
std::unique_ptr<render::HeadlessContext> Overlay::context_;
std::unique_ptr<client::Compositor> Overlay::compositor_;

// Whether the pixels at a place, within a dot's radius, show a colour but for an edge's antialiasing.
bool shows(const render::Image& image, const Eigen::Vector2f& place, ImU32 colour) {
    const auto channel = [&](int shift) { return static_cast<int>(colour >> shift & 0xffu); };
    const int x = static_cast<int>(place.x()), y = static_cast<int>(place.y());
    for (int j = std::max(y - 5, 0); j <= std::min(y + 5, image.height - 1); ++j) {
        for (int i = std::max(x - 5, 0); i <= std::min(x + 5, image.width - 1); ++i) {
            const std::uint8_t* const p = image.pixel(i, j);
            if (std::abs(p[0] - channel(IM_COL32_R_SHIFT)) < 24 &&
                std::abs(p[1] - channel(IM_COL32_G_SHIFT)) < 24 &&
                std::abs(p[2] - channel(IM_COL32_B_SHIFT)) < 24) {
                return true;
            }
        }
    }
    return false;
}

TEST_P(Overlay, TextIsWholeLegibleAndApart) {
    const Row& row = GetParam();
    DrawnScene moment(*source_, *shapes_);
    const render::Image image = picture(row, moment);
    const std::vector<test::DrawnLine> lines = test::drawn_lines();
    const std::string all = test::sentence(lines);
    for (const std::string& words : row.words) {
        EXPECT_NE(all.find(words), std::string::npos) << "'" << words << "' is not in: " << all;
    }
    EXPECT_EQ(test::overlapping(lines), "");
    const Eigen::AlignedBox2f whole(
        Eigen::Vector2f::Zero(),
        Eigen::Vector2f(static_cast<float>(image.width), static_cast<float>(image.height)));
    for (const test::DrawnLine& line : lines) {
        EXPECT_TRUE(whole.contains(line.box) && line.clip.contains(line.box)) << line.text;
        // WCAG 2.1, level AA.
        EXPECT_GE(test::contrast(line, image), 4.5) << line.text;
    }
    if (row.golden) {
        const render::Image window = row.panel ? beside_panel(image, row, moment.scene) : image;
        EXPECT_TRUE(test::matches_golden(window, golden(row.name), most_apart));
    }
}

INSTANTIATE_TEST_SUITE_P(Rows, Overlay, ::testing::ValuesIn(table()),
                         [](const auto& one) { return std::string(one.param.name); });

TEST_P(Overlay, TextIsLegibleInEveryLanguage) {
    const Row& row = GetParam();
    for (const text::Language& language : text::languages()) {
        text::set_language(language.code);
        DrawnScene moment(*source_, *shapes_);
        const render::Image image = picture(row, moment);
        const std::vector<test::DrawnLine> lines = test::drawn_lines();
        EXPECT_EQ(test::overlapping(lines), "") << language.code;
        const Eigen::AlignedBox2f whole(
            Eigen::Vector2f::Zero(),
            Eigen::Vector2f(static_cast<float>(image.width), static_cast<float>(image.height)));
        for (const test::DrawnLine& line : lines) {
            EXPECT_TRUE(whole.contains(line.box) && line.clip.contains(line.box))
                << language.code << ": " << line.text;
            EXPECT_GE(test::contrast(line, image), 4.5) << language.code << ": " << line.text;
        }
    }
    text::set_language("en");
}

TEST_F(Overlay, MarksAreDrawnWhereProjected) {
    for (const Row& row : table()) {
        if (row.happens != everything && std::string_view(row.name) != "aids_in_section") {
            continue;
        }
        DrawnScene moment(*source_, *shapes_);
        const render::Image image = picture(row, moment);
        const Selection& selection = *client::selection_named(row.view);
        const client::Views views = selection.views(moment.scene);
        const auto look = client::find_line_of_sight(views, moment.scene, {});
        int seen = 0;
        for (const auto& [view, tile] : client::layout(views, row.width, row.height, selection.arrangement)) {
            for (const hud::Mark& mark :
                 client::aid_marks(*view, view->camera(moment.scene, {}), moment.scene, {}, look, tile)) {
                int inside = 0, drawn = 0;
                for (int i = 0; i < 100; ++i) {
                    const Eigen::Vector2f place =
                        mark.from + static_cast<float>(i) / 100.0f * (mark.to - mark.from);
                    const Eigen::Array2f offset = place.array() - Eigen::Array2f(static_cast<float>(tile.x),
                                                                                 static_cast<float>(tile.y));
                    if ((offset >= 0.0f).all() && offset.x() < static_cast<float>(tile.width) &&
                        offset.y() < static_cast<float>(tile.height)) {
                        ++inside;
                        drawn += shows(image, place, hud::colour_of(mark.level)) ? 1 : 0;
                    }
                }
                // Texts, and dots of other levels, cover less than half of a line.
                EXPECT_GE(2 * drawn, inside) << row.name << ", " << view->name << ": " << mark.text;
                seen += inside > 0 ? 1 : 0;
            }
        }
        EXPECT_GE(seen, 2) << row.name;
    }
}

TEST_F(Overlay, GoldenPictureDetectsMovedEye) {
    const Row& eye = table()[1];
    DrawnScene moment(*source_, *shapes_);
    render::Vantage aside;
    aside.eye = view::TraineeEye(Vec3f(0.01f, 0.0f, 0.0f));
    EXPECT_GT(test::share_apart(picture(eye, moment, aside), render::read_png(golden("eye"))), most_apart);
}

// The trainee's left eye in a headset, with the laser pointer's ray.
TEST_F(Overlay, HeadsetEyeMatchesReferenceImage) {
    DrawnScene moment(*source_, *shapes_);
    moment.live.view_enhanced = 1.0f;
    moment.press(2.5f);
    moment.draw_on_the_forehead();
    moment.say();
    constexpr int side = 480;
    const RigidTransform to_patient = hmd::Room().patient(0.0f).inverse();
    const RigidTransform hand = RigidTransform::from(
        Quatf::FromTwoVectors(-Vec3f::UnitZ(),
                              client::HeadsetPanel::place().pose.translation - Vec3f(0.05f, -0.2f, -0.2f)),
        {0.05f, -0.2f, -0.2f});
    render::Vantage from;
    for (const float aside : {-0.032f, 0.032f}) {
        const auto eye =
            RigidTransform::from(Quatf(Eigen::AngleAxisf(-0.5f, Vec3f::UnitX())), {aside, 0.0f, 0.0f});
        from.headset_eyes.push_back(render::headset_camera(to_patient * eye, {-0.6f, 0.6f, 0.5f, -0.6f}));
    }
    from.eye = view::TraineeEye::from_headset(to_patient *
                                              RigidTransform::from(Quatf::Identity(), {0.032f, 0.0f, 0.0f}));
    compositor_.reset();  // the text overlay is one
    client::EyeCompositor eyes(side, side, render::qualities().front());
    const client::LaserRay ray{to_patient * hand.translation, to_patient * (hand * Vec3f(0.0f, 0.0f, -0.9f))};
    ASSERT_TRUE(test::eventually(
        [&] {
            eyes.draw_eyes(moment.scene, from, false);
            return eyes.has_patient();
        },
        std::chrono::seconds(60)));
    eyes.draw_eyes(moment.scene, from, true, {&ray, 1});
    const render::Image both = eyes.stereo().read();
    render::Image left{side, side, {}};
    for (int y = 0; y < side; ++y) {
        left.rgba.insert(left.rgba.end(), both.pixel(0, y), both.pixel(0, y) + 4 * side);
    }
    EXPECT_TRUE(test::matches_golden(left, golden("headset_eye"), most_apart));
}

}  // namespace
}  // namespace eti
