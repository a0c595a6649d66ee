// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors

// Each overlay of the enhanced view, and each role, against golden/: one table of name, view and session
// state. Pictures are compared where the overlay is drawn; differences between drivers in the scene below do
// not count.
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>

#include "client/app/aids.hpp"
#include "client/app/headset/eye_compositor.hpp"
#include "client/app/headset/headset_panel.hpp"
#include "client/app/window/command_keys.hpp"
#include "client/app/window/compositor.hpp"
#include "client/hmd/room.hpp"
#include "client/panel/panel_renderer.hpp"
#include "client/render/gl/headless_context.hpp"
#include "client/render/views/pick.hpp"
#include "common/bus/security/session_keys.hpp"
#include "synthetic_scene.hpp"
#include "tests/support/eventually.hpp"
#include "tests/support/golden.hpp"

namespace eti {
namespace {

using client::Selection;

constexpr std::uint64_t now_ns = 24'300'000'000;

// The session's state at one moment, for one picture.
class Moment {
  public:
    /// `shapes`: all of `source` has been applied to it.
    Moment(const synthetic::Scene& source, const view::SceneView& shapes)
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

enum class Panel { none, commands, watching };

struct Row {
    const char* name;
    const char* view;
    void (*happens)(Moment&);
    int width = 640, height = 360;  // of the window
    Panel panel = Panel::none;

    [[nodiscard]] panel::Area scene_area() const {
        return panel == Panel::none ? panel::Area{0, 0, width, height} : panel::scene_area(width, height);
    }
};

void nothing(Moment&) {}

template <float RuntimeParameters::*aid>
void shows(Moment& moment) {
    moment.live.*aid = 1.0f;
}

const std::vector<Row>& table() {
    static const std::vector<Row> rows{
        {"axes", "section", shows<&RuntimeParameters::view_axes>},
        {"gum_force", "eye",
         [](Moment& moment) {
             moment.live.view_gum_force = 1.0f;
             moment.press(5.0f);
         }},
        {"gum_force_in_section", "section",
         [](Moment& moment) {
             moment.live.view_gum_force = 1.0f;
             moment.press(2.5f);
         }},
        {"sight_dot", "eye", shows<&RuntimeParameters::view_sight_line>},
        {"sight_line", "section", shows<&RuntimeParameters::view_sight_line>},
        {"glottis", "eye",
         [](Moment& moment) {
             // In front of the face, where nothing covers it.
             moment.live.view_glottis = 1.0f;
             for (int i = 0; i < 16; ++i) {
                 const float angle = 6.2832f * static_cast<float>(i) / 16.0f;
                 moment.metrics.glottis_contour().push_back(
                     bus::to_msg(Vec3f(0.012f * std::cos(angle), -0.02f, 0.02f + 0.02f * std::sin(angle))));
             }
         }},
        {"clock", "eye", shows<&RuntimeParameters::view_clock>},
        {"clock_over_the_limit", "eye",
         [](Moment& moment) {
             moment.live.view_clock = 1.0f;
             moment.parameters.time_s = 31.7;
         }},
        {"tube_depth", "eye", shows<&RuntimeParameters::view_tube_depth>},
        {"warnings", "eye",
         [](Moment& moment) {
             moment.live.view_warnings = 1.0f;
             moment.metrics.tube_place(msg::TUBE_IN_OESOPHAGUS);
             moment.press(5.0f);
         }},
        {"success", "eye",
         [](Moment& moment) { moment.scene.apply(synthetic::summary(1, true, now_ns - 1'000'000'000)); }},
        {"no_success", "eye",
         [](Moment& moment) { moment.scene.apply(synthetic::summary(1, false, now_ns - 1'000'000'000)); }},
        {"vital_signs", "eye",
         [](Moment& moment) {
             moment.parameters.oxygen_saturation_end_percent = 78.0;
             moment.parameters.heart_rate_end_per_min = 96.0;
         }},
        {"note", "eye", [](Moment& moment) { moment.write(msg::ANNOTATION_NOTE, "sweep the tongue aside"); }},
        {"marks", "overview", [](Moment& moment) { moment.draw_on_the_forehead(); }},
        {"device_silent", "eye",
         [](Moment& moment) {
             moment.status.laryngoscope(msg::DEVICE_SILENT);
             moment.status.tube(msg::DEVICE_SILENT);
             moment.status.phase(msg::PHASE_FROZEN);
         }},
        {"two_servers", "eye", [](Moment& moment) { moment.contested = true; }},
        {"server_lost", "eye", [](Moment& moment) { moment.lost = true; }},
        {"refusal", "eye",
         [](Moment& moment) {
             moment.own.notice =
                 "refused: secretion: there is no liquid in this scenario; restart it with 'saliva: standby'";
         }},
        {"keys", "eye",
         [](Moment& moment) {
             for (const client::CommandKey& key : client::command_keys()) {
                 moment.own.keys.emplace_back(key.caption, key.help);
             }
         }},
        {"guidance", "eye",
         [](Moment& moment) {
             moment.own.guidance = {"2 of 5: blade in",
                                    "Drag with the left button: the blade's tip follows, by the right corner "
                                    "of the mouth over the tongue."};
         }},
        {"all_at_once", "auto",
         [](Moment& moment) {
             moment.live.view_enhanced = 1.0f;
             moment.metrics.tube_place(msg::TUBE_IN_OESOPHAGUS);
             moment.parameters.oxygen_saturation_end_percent = 91.0;
             moment.parameters.heart_rate_end_per_min = 128.0;
             moment.press(5.0f);
         }},
        {"all_at_once_upright", "auto",
         [](Moment& moment) {
             moment.live.view_enhanced = 1.0f;
             moment.press(2.5f);
         },
         360, 640},
        {"four_small", "four",
         [](Moment& moment) {
             moment.live.view_enhanced = 1.0f;
             moment.write(msg::ANNOTATION_NOTE, "sweep the tongue aside");
             moment.draw_on_the_forehead();
         }},
        // The roles, in a newly opened window; with the panel for roles that have one.
        {"trainee", "auto", shows<&RuntimeParameters::view_enhanced>, 960, 540},
        {"instructor", "four",
         [](Moment& moment) {
             moment.live.view_enhanced = 1.0f;
             moment.write(msg::ANNOTATION_NOTE, "sweep the tongue aside");
             moment.draw_on_the_forehead();
         },
         960, 540, Panel::commands},
        {"observer", "auto", [](Moment& moment) { moment.draw_on_the_forehead(); }, 960, 540,
         Panel::watching},
    };
    return rows;
}

// Letters and lines are drawn pixel by pixel: drivers differ at few edges. A changed digit differs by more.
constexpr double most_apart = 5e-3;
// As for the golden pictures of eti-bench render: how drivers shade a scene.
constexpr double most_of_scene_apart = 0.02;

class Golden : public ::testing::TestWithParam<Row> {
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

    static render::Image picture(const Row& row) {
        Moment moment(*source_, *shapes_);
        row.happens(moment);
        moment.say();
        hud::Readout readout = hud::make_readout(moment.scene, moment.lost, moment.contested);
        readout.keys = moment.own.keys;
        readout.notice = moment.own.notice;
        readout.guidance = moment.own.guidance;
        const Selection& selection = *client::selection_named(row.view);
        const panel::Area area = row.scene_area();
        if (!compositor_) {
            compositor_ = std::make_unique<client::Compositor>(640, 360, render::qualities().front());
        }
        compositor_->resize(area.width, area.height);
        compositor_->draw(selection.views(moment.scene), moment.scene, readout, {}, false,
                          selection.arrangement);
        const render::Image scene = compositor_->target().read();
        return row.panel == Panel::none ? scene : beside_panel(scene, row, moment.scene);
    }
    static render::Image beside_panel(const render::Image& scene, const Row& row,
                                      const view::SceneView& says) {
        panel::Model model(row.panel == Panel::commands
                               ? panel::Model::Send([](std::string_view, float) { return true; })
                               : panel::Model::Send());
        panel::PanelRenderer drawing;
        panel::Model::Time now(std::chrono::seconds(100));
        model.follow(says, {}, now);
        render::RenderTarget window(row.width, row.height, 1);
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

    // Pixels of a row's picture that differ from the golden one, and the pixels that the row's overlay
    // covers: where either picture differs from the scene alone. For the panel, all.
    struct Difference {
        int apart = 0, covered = 0, scene_apart = 0, scene = 0;
    };
    static Difference difference(const Row& row, const render::Image& drawn, const render::Image& kept) {
        const panel::Area area = row.scene_area();
        const Row alone{"plain", row.view, nothing, area.width, area.height};
        const render::Image plain = picture(alone);
        const render::Image kept_plain =
            test::golden(ETI_GOLDEN,
                         "plain_" + std::string(row.view) + "_" + std::to_string(area.width) + "x" +
                             std::to_string(area.height),
                         plain);
        Difference out;
        for (int y = 0; y < drawn.height; ++y) {
            for (int x = 0; x < drawn.width; ++x) {
                const bool of_scene =
                    x >= area.x && x < area.x + area.width && y >= area.y && y < area.y + area.height;
                bool covered = !of_scene;
                if (of_scene) {
                    const int u = x - area.x, v = y - area.y;
                    const bool added = test::pixels_differ(drawn.pixel(x, y), plain.pixel(u, v));
                    const bool was_added = test::pixels_differ(kept.pixel(x, y), kept_plain.pixel(u, v));
                    covered = added || was_added;
                    out.scene_apart += test::pixels_differ(plain.pixel(u, v), kept_plain.pixel(u, v)) ? 1 : 0;
                    ++out.scene;
                }
                out.covered += covered ? 1 : 0;
                out.apart += covered && test::pixels_differ(drawn.pixel(x, y), kept.pixel(x, y)) ? 1 : 0;
            }
        }
        return out;
    }

    // The whole picture; `most`: share of its pixels that may differ.
    static void compare(const std::string& name, const render::Image& drawn, double most) {
        const render::Image kept = test::golden(ETI_GOLDEN, name, drawn);
        ASSERT_EQ(kept.width, drawn.width);
        ASSERT_EQ(kept.height, drawn.height);
        int apart = 0;
        for (int y = 0; y < drawn.height; ++y) {
            for (int x = 0; x < drawn.width; ++x) {
                apart += test::pixels_differ(drawn.pixel(x, y), kept.pixel(x, y)) ? 1 : 0;
            }
        }
        EXPECT_LE(apart, most * drawn.width * drawn.height) << test::save_for_inspection(drawn, name);
    }

    static std::unique_ptr<synthetic::Scene> source_;
    static std::unique_ptr<view::SceneView> shapes_;
    static std::unique_ptr<render::HeadlessContext> context_;
    static std::unique_ptr<client::Compositor> compositor_;
};
std::unique_ptr<synthetic::Scene> Golden::source_;
std::unique_ptr<view::SceneView> Golden::shapes_;
std::unique_ptr<render::HeadlessContext> Golden::context_;
std::unique_ptr<client::Compositor> Golden::compositor_;

TEST_P(Golden, MatchesReferenceImage) {
    const Row& row = GetParam();
    const render::Image drawn = picture(row);
    const render::Image kept = test::golden(ETI_GOLDEN, row.name, drawn);
    ASSERT_EQ(kept.width, drawn.width);
    ASSERT_EQ(kept.height, drawn.height);
    const Difference found = difference(row, drawn, kept);
    EXPECT_GT(found.covered, 60) << row.name << " adds nothing";
    EXPECT_LE(found.apart, most_apart * found.covered)
        << row.name << ", of " << found.covered << " pixels; " << test::save_for_inspection(drawn, row.name);
    EXPECT_LE(found.scene_apart, most_of_scene_apart * found.scene)
        << "the view " << row.view << " by itself";
}

INSTANTIATE_TEST_SUITE_P(Overlays, Golden, ::testing::ValuesIn(table()),
                         [](const auto& one) { return std::string(one.param.name); });

// The trainee's left eye in a headset, and the panel beside the patient with the pointer.
TEST_F(Golden, HeadsetEyeAndPanelMatchReferenceImage) {
    Moment moment(*source_, *shapes_);
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
    {
        client::EyeCompositor eyes(side, side, render::qualities().front());
        const client::LaserRay ray{to_patient * hand.translation,
                                   to_patient * (hand * Vec3f(0.0f, 0.0f, -0.9f))};
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
        compare("headset_eye", left, most_of_scene_apart);
    }
    hmd::HandInput hands;
    hands.hands[1].aim = hand;
    client::LaserPointer laser;
    const hmd::Quad place = client::HeadsetPanel::place();
    laser.follow(&place, hands);
    panel::Model model([](std::string_view, float) { return true; });
    panel::Model::Time now(std::chrono::seconds(100));
    model.follow(moment.scene, {}, now);
    panel::PanelRenderer drawing;
    const render::RenderTarget picture(client::HeadsetPanel::width, client::HeadsetPanel::height, 1);
    picture.bind_picture();
    for (int i = 0; i < 3; ++i) {
        glClear(GL_COLOR_BUFFER_BIT);
        drawing.set_pointer(laser.pointer(picture.width(), picture.height()));
        drawing.draw_full_screen(model, picture.width(), picture.height(),
                                 now += std::chrono::milliseconds(16));
    }
    compare("headset_panel", picture.read(), 1e-3);
}

// The purpose of the comparison: it detects a number's changed last digit, a moved mark, a missing line.
TEST_F(Golden, ComparisonDetectsChangedDigitMarkOrLine) {
    const auto row_of = [](const char* view, void (*happens)(Moment&)) { return Row{"", view, happens}; };
    const auto differ = [&](const Row& a, const Row& b) {
        const Difference found = difference(a, picture(a), picture(b));
        return found.apart > most_apart * found.covered;
    };
    const Row clock = row_of("eye", shows<&RuntimeParameters::view_clock>);
    EXPECT_FALSE(differ(clock, clock));
    EXPECT_TRUE(differ(clock, row_of("eye", [](Moment& moment) {
                           moment.live.view_clock = 1.0f;
                           moment.parameters.time_s = 24.4;
                       })));
    const Row dot = row_of("section", shows<&RuntimeParameters::view_sight_line>);
    EXPECT_TRUE(differ(dot, row_of("section", nothing)));
    const auto pressed = [](Moment& moment) {
        moment.live.view_gum_force = 1.0f;
        moment.press(2.5f);
    };
    EXPECT_TRUE(differ(row_of("eye", pressed), row_of("eye", [](Moment& moment) {
                           moment.live.view_gum_force = 1.0f;
                           synthetic::set(moment.metrics, &LiveMeasures::gum_force_n,
                                          2.5f);  // at the gum's middle
                       })));
}

}  // namespace
}  // namespace eti
