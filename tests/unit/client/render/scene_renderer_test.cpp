// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/scene_renderer.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "client/render/headless_context.hpp"
#include "client/render/render_target.hpp"
#include "common/bus/fluid_state.hpp"
#include "synthetic_scene.hpp"

namespace eti {
namespace {

using Colour = std::array<std::uint8_t, 3>;
using render::Shading;
using render::View;

constexpr int width = 320, height = 240;

const View& named(std::string_view name) {
    return *render::view_named(name);
}

class SceneRendererTest : public ::testing::Test {
  protected:
    [[nodiscard]] render::Image picture(const View& view, const view::SceneView& scene, Shading shading) {
        target_.bind_scene();
        renderer_.sync(scene);
        renderer_.draw(view, scene, {0, 0, width, height}, {}, shading);
        target_.resolve();
        return target_.read();
    }

    static int count(const render::Image& image, const Colour& colour) {
        int pixels = 0;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const std::uint8_t* p = image.pixel(x, y);
                pixels += p[0] == colour[0] && p[1] == colour[1] && p[2] == colour[2] ? 1 : 0;
            }
        }
        return pixels;
    }

    // Mean row, 0 at the top, of the pixels of one colour.
    static double mean_row(const render::Image& image, const Colour& colour) {
        double sum = 0.0;
        int pixels = 0;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const std::uint8_t* p = image.pixel(x, y);
                if (p[0] == colour[0] && p[1] == colour[1] && p[2] == colour[2]) {
                    sum += y;
                    ++pixels;
                }
            }
        }
        return pixels > 0 ? sum / pixels : -1.0;
    }

    void SetUp() override { synthetic::fill(scene_, source_); }
    void TearDown() override { EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR)); }

    synthetic::Scene source_ = synthetic::make_scene();
    view::SceneView scene_;
    render::HeadlessContext context_;
    render::SceneRenderer renderer_;
    render::RenderTarget target_{width, height, 1};
};

TEST_F(SceneRendererTest, OverviewShowsHeadBladeAndTube) {
    const render::Image ids = picture(named("overview"), scene_, Shading::object_id);
    const int all = width * height;
    // The head alone, 100 x 120 mm seen from 0.62 m in a field of 26 deg (286 mm), is a quarter of the
    // picture's height squared; handle (18 x 100 mm) and tube (4 x 80 mm) are lines of it.
    EXPECT_GT(count(ids, render::object_colour(Tissue::soft)), all / 20);
    EXPECT_GT(count(ids, render::blade_colour), all / 200);
    EXPECT_GT(count(ids, render::tube_colour), all / 1000);
    EXPECT_EQ(count(ids, render::object_colour(Tissue::skull)), 0) << "bone lies inside";
}

TEST_F(SceneRendererTest, SectionFillsWhatThePlaneCuts) {
    // No tools, nothing lifted: what is cut are ellipses of known area.
    view::SceneView bare;
    bare.apply(source_.description);
    for (const auto& object : source_.objects) {
        bare.apply(object);
    }
    bare.update();
    const render::Image ids = picture(named("section"), bare, Shading::object_id);
    // 120 mm of the plane fill the picture's height.
    const double pixels_per_square_metre = std::pow(height / 0.120, 2);
    const double tongue = std::numbers::pi * 0.016 * 0.007 * pixels_per_square_metre;
    const double spine = std::numbers::pi * 0.05 * 0.005 * pixels_per_square_metre;
    // An ellipse of n pixels across its short side is wrong by at most half a pixel along its rim on
    // average zero; facets of 1 mm inside a 7 mm radius take 1 %. 4 % covers both.
    EXPECT_NEAR(count(ids, render::object_colour(Tissue::tongue)), tongue, 0.04 * tongue);
    // The spine's lower half lies outside the picture at least in part.
    EXPECT_GT(count(ids, render::object_colour(Tissue::spine)), 0.3 * spine);
    EXPECT_LT(count(ids, render::object_colour(Tissue::spine)), 1.04 * spine);
    EXPECT_GT(count(ids, render::object_colour(Tissue::soft)), width * height / 5);
}

TEST_F(SceneRendererTest, SectionShowsToolsOnTopOfTheCut) {
    const render::Image ids = picture(named("section"), scene_, Shading::object_id);
    EXPECT_GT(count(ids, render::blade_colour), 200);
    EXPECT_GT(count(ids, render::tube_colour), 200);
}

TEST_F(SceneRendererTest, LaryngoscopeLooksIntoTheMouthWithTheBladeAbove) {
    const render::Image ids = picture(named("laryngoscope"), scene_, Shading::object_id);
    ASSERT_GT(count(ids, render::blade_colour), 100);
    ASSERT_GT(count(ids, render::tube_colour), 100);
    EXPECT_LT(mean_row(ids, render::blade_colour), height / 2.0);
    EXPECT_GT(mean_row(ids, render::object_colour(Tissue::tongue)), mean_row(ids, render::blade_colour));
}

TEST_F(SceneRendererTest, PicturesAreLitAndTheSameBitByBit) {
    for (const View& view : render::views()) {
        const render::Image first = picture(view, scene_, Shading::lit);
        render::SceneRenderer other;
        target_.bind_scene();
        other.sync(scene_);
        other.draw(view, scene_, {0, 0, width, height});
        target_.resolve();
        EXPECT_EQ(first.rgba, target_.read().rgba) << view.name;
        // Many shades, none of them a NaN's black speck amid the lit head.
        std::array<bool, 256> seen{};
        for (std::size_t i = 0; i < first.rgba.size(); i += 4) {
            seen[first.rgba[i]] = true;
        }
        EXPECT_GT(std::count(seen.begin(), seen.end(), true), 60) << view.name;
    }
}

TEST_F(SceneRendererTest, LiquidIsDrawnWhereItIsAndNothingElseChanges) {
    // A drop of 5 mm before the mouth, on the half that the section keeps.
    view::SceneView wet = scene_;
    const Vec3f before_mouth = at(scene_.landmarks(), Landmark::mouth_opening) + Vec3f(-0.01f, -0.02f, 0.0f);
    std::vector<Vec3f> drop;
    for (int k = 0; k < 5 * 5 * 5; ++k) {
        drop.push_back(before_mouth + 1e-3f * Eigen::Vector3i(k % 5, k / 5 % 5, k / 25).cast<float>());
    }
    msg::FluidState message;
    bus::put_fluid_chunk({Vec3f::Constant(-0.1f), Vec3f::Constant(0.1f), 1e-3f, drop}, 0, message);
    ASSERT_TRUE(wet.apply(message));
    wet.update();
    for (const View& view : render::views()) {
        const render::Image dry_picture = picture(view, scene_, Shading::lit);
        const render::Image wet_picture = picture(view, wet, Shading::lit);
        const Eigen::Matrix4f projection =
            view.camera(wet, {}).projection(static_cast<float>(width) / height) * view.camera(wet, {}).view();
        const Eigen::Vector4f clip = projection * (drop.front() + Vec3f::Constant(2e-3f)).homogeneous();
        const Eigen::Vector2f centre = Eigen::Vector2f(0.5f * width * (1.0f + clip.x() / clip.w()),
                                                       0.5f * height * (1.0f - clip.y() / clip.w()));
        const float pixels_per_metre = 0.5f * height * projection.block<1, 3>(1, 0).norm() / clip.w();
        // Half the drop's diagonal and a sphere beyond it.
        const float reach = 7e-3f * pixels_per_metre + 2.0f;
        int changed = 0;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                if (std::memcmp(dry_picture.pixel(x, y), wet_picture.pixel(x, y), 3) != 0) {
                    ++changed;
                    EXPECT_LT((Eigen::Vector2f(static_cast<float>(x), static_cast<float>(y)) - centre).norm(),
                              reach)
                        << view.name << " at " << x << ", " << y;
                }
            }
        }
        // Of the square of the drop's outer particles at least a quarter: the rest may be hidden.
        EXPECT_GT(static_cast<float>(changed), 0.25f * std::pow(4e-3f * pixels_per_metre, 2.0f)) << view.name;
    }
    // What is measured on flat colours does not see it.
    EXPECT_EQ(picture(named("section"), scene_, Shading::object_id).rgba,
              picture(named("section"), wet, Shading::object_id).rgba);
}

// As a client does that keeps the scene of the best view: both go on from the same shape, one update each.
TEST_F(SceneRendererTest, ACopyThatWentItsOwnWayIsDrawnAsItIs) {
    const View& section = named("section");
    view::SceneView kept = scene_;
    kept.apply(synthetic::deformation(source_, 2'000'000, 0.0f, 0.0f));
    scene_.apply(synthetic::deformation(source_, 2'000'000, 0.006f, 0.02f));
    kept.update();
    scene_.update();
    (void)picture(section, scene_, Shading::lit);
    const render::Image after_another = picture(section, kept, Shading::lit);
    render::SceneRenderer fresh;
    target_.bind_scene();
    fresh.sync(kept);
    fresh.draw(section, kept, {0, 0, width, height});
    target_.resolve();
    EXPECT_EQ(after_another.rgba, target_.read().rgba);
}

TEST_F(SceneRendererTest, SmoothedEdgesKeepThePicture) {
    const render::Image plain = picture(named("section"), scene_, Shading::lit);
    render::RenderTarget smooth(width, height, 4);
    smooth.bind_scene();
    renderer_.draw(named("section"), scene_, {0, 0, width, height});
    smooth.resolve();
    const render::Image averaged = smooth.read();
    double difference = 0.0;
    for (std::size_t i = 0; i < plain.rgba.size(); ++i) {
        difference += std::abs(static_cast<int>(plain.rgba[i]) - static_cast<int>(averaged.rgba[i]));
    }
    // Only edges differ; they are a few per cent of the pixels and by less than full contrast.
    EXPECT_LT(difference / static_cast<double>(plain.rgba.size()), 5.0);
    EXPECT_GT(difference, 0.0);
}

TEST_F(SceneRendererTest, AnIncompleteSceneDrawsOnlyBackground) {
    view::SceneView partial;
    partial.apply(source_.objects[1]);
    render::SceneRenderer renderer;
    target_.bind_scene();
    renderer.sync(partial);
    renderer.draw(named("overview"), partial, {0, 0, width, height}, {}, Shading::object_id);
    target_.resolve();
    EXPECT_EQ(count(target_.read(), {0, 0, 0}), width * height);
}

}  // namespace
}  // namespace eti
