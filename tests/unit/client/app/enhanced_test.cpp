// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "client/app/aids.hpp"
#include "client/app/window/compositor.hpp"
#include "client/render/gl/headless_context.hpp"
#include "common/bus/security/session_keys.hpp"
#include "synthetic_scene.hpp"

namespace eti {
namespace {

constexpr int enhanced_width = 640, enhanced_height = 360;

// Effect of the session's enhanced view on drawn pixels.
class EnhancedView : public ::testing::Test {
  protected:
    void SetUp() override { synthetic::fill(scene_, source_); }

    void say(bool enhanced, float gum_force) {
        RuntimeParameters live;
        live.view_enhanced = enhanced ? 1.0f : 0.0f;
        say(live, gum_force);
    }
    void say(const RuntimeParameters& live, float gum_force) {
        auto metrics = synthetic::metrics(source_, 2'000'000, 40.0f);
        bus::set_runtime_parameters(live, metrics);
        synthetic::set(metrics, &LiveMeasures::gum_force_n, gum_force);
        ASSERT_TRUE(scene_.apply(metrics));
    }
    [[nodiscard]] render::Image picture(std::string_view selection) {
        hud::Readout nothing_said;
        nothing_said.link = hud::ServerLink::running;
        compositor_.draw(client::selection_named(selection)->views(scene_), scene_, nothing_said, {}, false);
        return compositor_.target().read();
    }
    static bool differs(const render::Image& a, const render::Image& b, int x, int y) {
        return std::memcmp(a.pixel(x, y), b.pixel(x, y), 3) != 0;
    }
    // Number of pixels that differ, and how many of them are at least `distance` from (x, y).
    static std::pair<int, int> changed(const render::Image& a, const render::Image& b,
                                       const Eigen::Vector2f& about, float distance) {
        int all = 0, far = 0;
        for (int y = 0; y < enhanced_height; ++y) {
            for (int x = 0; x < enhanced_width; ++x) {
                if (differs(a, b, x, y)) {
                    ++all;
                    const Eigen::Vector2f place(static_cast<float>(x), static_cast<float>(y));
                    far += (place - about).norm() > distance ? 1 : 0;
                }
            }
        }
        return {all, far};
    }
    [[nodiscard]] Eigen::Vector2f gum_pixel(std::string_view view) const {
        return pixel_of(at(scene_.landmarks(), Landmark::upper_gum), view);
    }
    [[nodiscard]] Eigen::Vector2f pixel_of(const Vec3f& point, std::string_view view) const {
        const render::Camera camera = render::view_named(view)->camera(scene_, {});
        const Eigen::Vector4f clip = camera.projection(static_cast<float>(enhanced_width) / enhanced_height) *
                                     camera.view() * point.homogeneous();
        return {0.5f * enhanced_width * (1.0f + clip.x() / clip.w()),
                0.5f * enhanced_height * (1.0f - clip.y() / clip.w())};
    }

    synthetic::Scene source_ = synthetic::make_scene();
    view::SceneView scene_;
    render::HeadlessContext context_;
    client::Compositor compositor_{enhanced_width, enhanced_height, render::qualities().front()};
};

TEST_F(EnhancedView, AddsSectionBesideSelectedViews) {
    say(false, 1.0f);
    const render::Image plain = picture("auto");
    say(true, 1.0f);
    const render::Image enhanced = picture("auto");
    const auto tiles =
        client::layout(client::selection_named("auto")->views(scene_), enhanced_width, enhanced_height);
    ASSERT_EQ(tiles.size(), 4u);
    EXPECT_EQ(tiles.front().view->name, "eye");
    EXPECT_EQ(tiles[3].view->name, "section");
    // Most of the section's tile was another view's background.
    int inside = 0;
    for (int y = tiles[3].tile.y; y < enhanced_height; ++y) {
        for (int x = tiles[3].tile.x; x < enhanced_width; ++x) {
            inside += differs(plain, enhanced, x, y) ? 1 : 0;
        }
    }
    EXPECT_GT(inside, tiles[3].tile.width * tiles[3].tile.height / 2);
    say(false, 1.0f);
    EXPECT_EQ(picture("auto").rgba, plain.rgba) << "off again";
}

TEST_F(EnhancedView, ColoursGumMarkByForceInEveryView) {
    for (const render::View& view : render::views()) {
        if (!view.has(render::Overlay::gum_force)) {
            continue;
        }
        say(false, 1.0f);
        const render::Image plain = picture(view.name);
        const Eigen::Vector2f gum = gum_pixel(view.name);
        const int x = static_cast<int>(std::lround(gum.x())), y = static_cast<int>(std::lround(gum.y()));
        ASSERT_TRUE(x > 0 && x < enhanced_width && y > 0 && y < enhanced_height) << view.name;
        for (const auto& [force, red] : {std::pair{1.0f, false}, std::pair{5.0f, true}}) {
            RuntimeParameters mark_alone;
            mark_alone.view_gum_force = 1.0f;
            say(mark_alone, force);
            const render::Image marked = picture(view.name);
            const std::uint8_t* const at_gum = marked.pixel(x, y);
            EXPECT_EQ(at_gum[0] > at_gum[1], red) << view.name << " at " << force << " N";
            const auto [all, far] = changed(plain, marked, gum, 60.0f);
            EXPECT_GT(all, 60) << view.name;
            // A disc of 6 pixels and a number beside it.
            EXPECT_EQ(far, 0) << view.name;
        }
    }
}

TEST_F(EnhancedView, EachAidIsIndependent) {
    struct Case {
        float RuntimeParameters::*aid;
        std::string_view view;
    };
    for (const auto& [aid, view] : {Case{&RuntimeParameters::view_gum_force, "overview"},
                                    Case{&RuntimeParameters::view_sight_line, "section"},
                                    Case{&RuntimeParameters::view_axes, "section"}}) {
        const auto with = [&](float RuntimeParameters::*shown) {
            RuntimeParameters live;
            live.*shown = 1.0f;
            say(live, 1.0f);
            return picture(view);
        };
        say(RuntimeParameters{}, 1.0f);
        const render::Image plain = picture(view), alone = with(aid);
        const int by_itself = changed(plain, alone, Eigen::Vector2f::Zero(), 0.0f).first;
        EXPECT_GT(by_itself, 60) << view;
        EXPECT_GT(
            changed(plain, with(&RuntimeParameters::view_enhanced), Eigen::Vector2f::Zero(), 0.0f).first,
            by_itself)
            << view;
        for (const RuntimeParameterField& field : runtime_parameter_fields) {
            if (field.on_off && field.value != aid) {
                EXPECT_TRUE(with(field.value).rgba != alone.rgba) << field.name;
            }
        }
    }
}

TEST_F(EnhancedView, MarksGumAtContactPoint) {
    msg::ProxyState proxy = synthetic::proxy(source_, 3'000'000);
    const Vec3f gum = at(scene_.landmarks(), Landmark::upper_gum);
    const Vec3f pressed = gum + Vec3f(6e-3f, 0.0f, 0.0f);
    msg::ShellContact contact;
    contact.position().x(pressed.x());
    contact.position().y(pressed.y());
    contact.position().z(pressed.z());
    contact.force(2.0f);
    contact.tissue(static_cast<std::uint32_t>(Tissue::upper_gum));
    proxy.contacts().push_back(contact);
    ASSERT_TRUE(scene_.apply(proxy));
    say(true, 5.0f);
    const render::View& view = *render::view_named("overview");
    const auto marks = client::aid_marks(view, view.camera(scene_, {}), scene_, {}, std::nullopt,
                                         {"overview", 0, 0, enhanced_width, enhanced_height});
    const auto mark = std::ranges::find(marks, "5.0 N", &hud::Mark::text);
    ASSERT_NE(mark, marks.end());
    const Eigen::Vector2f there = pixel_of(pressed, "overview");
    EXPECT_LT((mark->from - there).norm(), 2.0f);
    EXPECT_GT((mark->from - pixel_of(gum, "overview")).norm(), 2.0f);
    EXPECT_EQ(mark->level, hud::Level::bad);
}

TEST_F(EnhancedView, TintsVisiblePartOfGlottis) {
    // A square of 4 mm, at a distance from the eye on the line to the glottis: in open air, or behind the
    // head.
    const render::View& view = *render::view_named("eye");
    const render::Camera camera = view.camera(scene_, {});
    const Vec3f way = (at(scene_.landmarks(), Landmark::glottis) - camera.eye).normalized();
    const Vec3f across = way.unitOrthogonal(), along = way.cross(across);
    const auto tinted = [&](float away) {
        auto metrics = synthetic::metrics(source_, 2'000'000, 40.0f);
        for (const auto& [i, j] : {std::pair{-1.0f, -1.0f}, {1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, 1.0f}}) {
            const Vec3f p = camera.eye + away * way + 2e-3f * (i * across + j * along);
            msg::Vec3& point = metrics.glottis_contour().emplace_back();
            point.x(p.x());
            point.y(p.y());
            point.z(p.z());
        }
        const auto drawn = [&](float shown) {
            RuntimeParameters live;
            live.view_glottis = shown;
            bus::set_runtime_parameters(live, metrics);
            EXPECT_TRUE(scene_.apply(metrics));
            return picture("eye");
        };
        const render::Image without = drawn(0.0f), with = drawn(1.0f);
        return changed(without, with, Eigen::Vector2f::Zero(), 0.0f).first;
    };
    // 4 mm at a quarter of a metre, in pixels.
    const float distance = 0.25f;
    const float side = 4e-3f / distance * 0.5f * static_cast<float>(enhanced_height) *
                       camera.projection(static_cast<float>(enhanced_width) / enhanced_height)(1, 1);
    EXPECT_NEAR(tinted(distance), side * side, 0.35f * side * side);
    EXPECT_EQ(tinted(1.0f), 0) << "behind the head";
}

TEST_F(EnhancedView, DrawsLineOfSightInSection) {
    say(false, 1.0f);
    const render::Image plain = picture("section");
    say(true, 1.0f);
    const render::Image sighted = picture("section");
    const render::Camera camera = render::view_named("section")->camera(scene_, {});
    const Eigen::Matrix4f matrix =
        camera.projection(static_cast<float>(enhanced_width) / enhanced_height) * camera.view();
    const Vec3f eye = best_eye(scene_.landmarks()), glottis = at(scene_.landmarks(), Landmark::glottis);
    int along = 0, drawn = 0;
    for (int i = 0; i <= 400; ++i) {
        const Vec3f point = eye + static_cast<float>(i) / 400.0f * (glottis - eye);
        const Eigen::Vector4f clip = matrix * point.homogeneous();
        const int x = static_cast<int>(0.5f * enhanced_width * (1.0f + clip.x() / clip.w()));
        const int y = static_cast<int>(0.5f * enhanced_height * (1.0f - clip.y() / clip.w()));
        if (x >= 2 && x < enhanced_width - 2 && y >= 2 && y < enhanced_height - 2) {
            ++along;
            const std::uint8_t* const p = sighted.pixel(x, y);
            const bool coloured = std::abs(p[0] - p[1]) > 60;
            drawn += coloured && differs(plain, sighted, x, y) ? 1 : 0;
        }
    }
    ASSERT_GT(along, 50);
    // Dots and their labels cover some of it, and gaps of the dashes are 4/14 of its hidden part.
    EXPECT_GT(drawn, along * 3 / 5);
}

// The last numbers of a lost server are outdated.
TEST_F(EnhancedView, StaleNumbersAreDimmed) {
    say(false, 5.0f);
    const auto brightest = [&](hud::ServerLink link) {
        hud::Readout readout = hud::make_readout(scene_, link == hud::ServerLink::lost);
        EXPECT_EQ(readout.link, link);
        // In the upper left.
        compositor_.draw(client::selection_named("section")->plain, scene_, readout, {}, false);
        const render::Image image = compositor_.target().read();
        int most = 0;
        for (int y = 8; y < 100; ++y) {
            for (int x = 8; x < 150; ++x) {
                most = std::max(most, static_cast<int>(image.pixel(x, y)[1]));
            }
        }
        return most;
    };
    EXPECT_GT(brightest(hud::ServerLink::running), 200);
    EXPECT_LT(brightest(hud::ServerLink::lost), 170);
}

TEST_F(EnhancedView, NoteExpires) {
    say(false, 1.0f);
    msg::ShownAnnotation note;
    note.header().simulation_time_ns(1'000'000);
    note.what().kind(msg::ANNOTATION_NOTE);
    note.what().text("sweep the tongue aside");
    ASSERT_TRUE(scene_.apply(note));
    EXPECT_EQ(hud::make_readout(scene_, false).note, "sweep the tongue aside");
    ASSERT_TRUE(scene_.apply(synthetic::deformation(source_, 16'000'000'000, 0.0f, 0.0f)));
    EXPECT_EQ(hud::make_readout(scene_, false).note, "");
}

TEST_F(EnhancedView, AnnotationTextIsDrawnAtItsPoint) {
    say(false, 1.0f);
    msg::ShownAnnotation shown;
    shown.what().kind(msg::ANNOTATION_POINT);
    shown.what().text("lift here");
    shown.what().object("tongue");
    shown.what().places().emplace_back().triangle(9);
    ASSERT_TRUE(scene_.apply(shown));
    const render::View& view = *render::view_named("overview");
    const auto marks = client::aid_marks(view, view.camera(scene_, {}), scene_, {}, std::nullopt,
                                         {"overview", 0, 0, enhanced_width, enhanced_height});
    const auto mark = std::ranges::find(marks, "lift here", &hud::Mark::text);
    ASSERT_NE(mark, marks.end());
    EXPECT_TRUE(mark->bare);
    const Vec3f where = *view::current_position(scene_, "tongue", {9, 0.0f, 0.0f, 0.0f});
    EXPECT_LT((mark->from - pixel_of(where, "overview")).norm(), 0.1f);
}

TEST_F(EnhancedView, KeepsExplicitlySelectedViews) {
    for (const client::Selection& one : client::selections()) {
        say(false, 1.0f);
        const client::Views plain = one.views(scene_);
        say(true, 1.0f);
        EXPECT_EQ(one.views(scene_) == plain, one.name != "auto") << one.name;
    }
}

}  // namespace
}  // namespace eti
