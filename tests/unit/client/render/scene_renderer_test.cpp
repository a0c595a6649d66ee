// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/scene_renderer.hpp"
#include "common/bus/codec/frame_pose.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>

#include "common/model/tools/blade_clearance_deformer.hpp"
#include "scene_picture.hpp"

namespace eti {
namespace {

using render::Shading;
using render::View;
using test::Colour;
using test::height;
using test::named;
using test::width;
using SceneRendererTest = test::ScenePicture;

TEST_F(SceneRendererTest, OverviewShowsHeadBladeAndTube) {
    const render::Image ids = picture(named("overview"), scene_, Shading::object_id);
    const int all = width * height;
    // The head alone, 100 x 120 mm seen from 0.62 m in a field of 26 deg (286 mm), is a quarter of the
    // picture's height squared. Handle (18 x 100 mm) and tube (4 x 80 mm) are lines of it.
    EXPECT_GT(count(ids, render::object_colour(Tissue::soft)), all / 20);
    EXPECT_GT(count(ids, render::blade_colour), all / 200);
    EXPECT_GT(count(ids, render::tube_colour), all / 1000);
    EXPECT_EQ(count(ids, render::object_colour(Tissue::skull)), 0) << "bone lies inside";
}

TEST_F(SceneRendererTest, SectionFillsCutOrgans) {
    // No tools, nothing lifted: the sections are ellipses of known area.
    view::SceneView bare;
    bare.apply(source_.description);
    for (const auto& object : source_.objects) {
        bare.apply(object);
    }
    bare.update();
    const render::Image ids = picture(named("section"), bare, Shading::object_id);
    // Height of the plane that fills the picture.
    const render::Camera camera = named("section").camera(bare, {});
    const float shown = 2.0f * (camera.eye - camera.target).norm() * std::tan(0.5f * camera.vertical_fov);
    const double pixels_per_square_metre = std::pow(height / static_cast<double>(shown), 2);
    const double tongue = std::numbers::pi * 0.016 * 0.007 * pixels_per_square_metre;
    const double spine = std::numbers::pi * 0.05 * 0.005 * pixels_per_square_metre;
    // An ellipse of n pixels across its short side is wrong by at most half a pixel along its rim, zero on
    // average; facets of 1 mm inside a 7 mm radius take 1 %. 4 % covers both.
    EXPECT_NEAR(count(ids, render::object_colour(Tissue::tongue)), tongue, 0.04 * tongue);
    // The spine's lower half lies outside the picture at least in part.
    EXPECT_GT(count(ids, render::object_colour(Tissue::spine)), 0.3 * spine);
    EXPECT_LT(count(ids, render::object_colour(Tissue::spine)), 1.04 * spine);
    EXPECT_GT(count(ids, render::object_colour(Tissue::soft)), width * height / 5);
}

// A ball inside the tongue, like its back while a blade folds it forward: tissue over tissue, which the
// section must not show.
TEST_F(SceneRendererTest, SelfIntersectingOrganHasNoOutlineInSection) {
    const render::Image plain = picture(named("section"), scene_, Shading::lit);
    synthetic::Scene folded = source_;
    auto& tongue = *std::ranges::find_if(folded.objects, [](auto& o) { return o.object() == "tongue"; });
    const Vec3f middle = folded.rest_centres[2];
    const std::vector<float> outer = tongue.vertices();
    const auto count = static_cast<std::uint32_t>(outer.size() / 3);
    for (std::size_t k = 0; k < outer.size(); ++k) {
        const float from = middle[static_cast<Eigen::Index>(k % 3)];
        tongue.vertices().push_back(from + 0.5f * (outer[k] - from));
    }
    const auto twice = [](auto& of, std::uint32_t more) {
        const std::size_t size = of.size();
        for (std::size_t k = 0; k < size; ++k) {
            of.push_back(static_cast<typename std::decay_t<decltype(of)>::value_type>(of[k] + more));
        }
    };
    twice(tongue.triangles(), count);
    twice(tongue.triangle_tissue(), 0);
    twice(tongue.skin_frame(), 0);
    twice(tongue.skin_weight(), 0);
    view::SceneView scene;
    synthetic::fill(scene, folded);
    int apart = 0;
    const render::Image cut = picture(named("section"), scene, Shading::lit);
    for (std::size_t p = 0; p < plain.rgba.size(); ++p) {
        apart = std::max(apart, std::abs(plain.rgba[p] - cut.rgba[p]));
    }
    EXPECT_LE(apart, 2) << "of 256";
}

TEST_F(SceneRendererTest, SectionShowsToolsOnTopOfCut) {
    const render::Image ids = picture(named("section"), scene_, Shading::object_id);
    EXPECT_GT(count(ids, render::blade_colour), 200);
    EXPECT_GT(count(ids, render::tube_colour), 200);
}

TEST_F(SceneRendererTest, LaryngoscopeViewIsMountedOnBlade) {
    const render::Image ids = picture(named("laryngoscope"), scene_, Shading::object_id);
    ASSERT_GT(count(ids, render::blade_colour), 100);
    EXPECT_LT(mean_row(ids, render::blade_colour), height / 2.0);
    EXPECT_GT(count(ids, render::object_colour(Tissue::soft)), width * height / 5) << "the throat around it";
    // Moving the eye leaves it where it is.
    const render::Vantage aside{.eye = view::TraineeEye(Vec3f(0.05f, 0.0f, 0.0f))};
    EXPECT_EQ(named("laryngoscope").camera(scene_, aside).eye, named("laryngoscope").camera(scene_, {}).eye);
    // Before the first blade pose it is the eye's close-up.
    view::SceneView bare;
    bare.apply(source_.description);
    EXPECT_LT((named("laryngoscope").camera(bare, aside).eye - named("eye").camera(bare, aside).eye).norm(),
              1e-6f);
}

TEST_F(SceneRendererTest, BladeLensFogClearsWithTime) {
    const View& lens = named("laryngoscope");
    const auto fogged = [&](const View& view, const view::SceneView& scene) {
        renderer_.sync(scene);
        renderer_.draw(view, scene, target_, {0, 0, width, height}, {.hands = false, .fogging = 1.0f});
        return target_.read();
    };
    const auto difference = [](const render::Image& a, const render::Image& b) {
        double sum = 0.0;
        for (std::size_t i = 0; i < a.rgba.size(); ++i) {
            sum += std::abs(static_cast<int>(a.rgba[i]) - static_cast<int>(b.rgba[i]));
        }
        return sum;
    };
    view::SceneView later = scene_;
    later.apply(synthetic::proxy(source_, 60'000'000'000));
    later.update();
    const render::Image clear = picture(lens, scene_, Shading::lit);
    const double at_first = difference(fogged(lens, scene_), clear);
    EXPECT_GT(at_first, 5.0 * width * height);
    EXPECT_LT(difference(fogged(lens, later), clear), 0.25 * at_first) << "a minute later";
    EXPECT_EQ(fogged(named("overview"), scene_).rgba, picture(named("overview"), scene_, Shading::lit).rgba);
}

TEST_F(SceneRendererTest, PicturesAreLitAndBitIdentical) {
    for (const View& view : render::views()) {
        const render::Image first = picture(view, scene_, Shading::lit);
        render::SceneRenderer other;
        other.sync(scene_);
        other.draw(view, scene_, target_, {0, 0, width, height}, {.hands = false});
        EXPECT_EQ(first.rgba, target_.read().rgba) << view.name;
        // Many shades, and no black speck of a NaN within the lit head.
        std::array<bool, 256> seen{};
        for (std::size_t i = 0; i < first.rgba.size(); i += 4) {
            seen[first.rgba[i]] = true;
        }
        EXPECT_GT(std::count(seen.begin(), seen.end(), true), 60) << view.name;
    }
}

// The refracting wall shows more of what lies behind than an opaque one; towards the rim it is displaced.
TEST_F(SceneRendererTest, TubeIsTranslucent) {
    // Before a plain surface of medium brightness: white plastic hardly differs from the towel.
    View view = named("overview");
    std::erase(view.passes, render::Pass::room);
    view.background = Vec3f(0.12f, 0.25f, 0.27f);
    view::SceneView bare;
    bare.apply(source_.description);
    for (const msg::SceneDescription& object : source_.objects) {
        bare.apply(object);
    }
    bare.apply(synthetic::proxy(source_, 1'000'000));
    bare.update();
    const auto difference = [&](std::string_view quality) {
        render::SceneRenderer renderer(*render::quality_named(quality));
        const auto drawn = [&](const view::SceneView& scene, Shading shading) {
            renderer.sync(scene);
            renderer.draw(view, scene, target_, {0, 0, width, height}, {.hands = false}, shading);
            return target_.read();
        };
        const render::Image ids = drawn(scene_, Shading::object_id);
        const render::Image with = drawn(scene_, Shading::lit), without = drawn(bare, Shading::lit);
        double sum = 0.0;
        int pixels = 0;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const std::uint8_t* id = ids.pixel(x, y);
                if (Colour{id[0], id[1], id[2]} == render::tube_colour) {
                    for (int c = 0; c < 3; ++c) {
                        sum += std::abs(with.pixel(x, y)[c] - without.pixel(x, y)[c]);
                    }
                    ++pixels;
                }
            }
        }
        EXPECT_GT(pixels, 100);
        return sum / pixels;
    };
    const double covered = difference("low"), clear = difference("medium");
    // The clear tube also mirrors the room, which the covering one does not.
    EXPECT_LT(clear, 0.9 * covered);
    EXPECT_GT(clear, 5.0) << "it is not invisible";
}

// Like a client that keeps the scene of the best view: both continue from the same shape, one update each.
TEST_F(SceneRendererTest, DivergedSceneCopyIsDrawnCorrectly) {
    const View& section = named("section");
    view::SceneView kept = scene_;
    kept.apply(synthetic::deformation(source_, 2'000'000, 0.0f, 0.0f));
    scene_.apply(synthetic::deformation(source_, 2'000'000, 0.006f, 0.02f));
    kept.update();
    scene_.update();
    (void)picture(section, scene_, Shading::lit);
    const render::Image after_another = picture(section, kept, Shading::lit);
    render::SceneRenderer fresh;
    fresh.sync(kept);
    fresh.draw(section, kept, target_, {0, 0, width, height});
    EXPECT_EQ(after_another.rgba, target_.read().rgba);
}

TEST_F(SceneRendererTest, AntialiasingChangesOnlyEdges) {
    const render::Image plain = picture(named("section"), scene_, Shading::lit);
    render::RenderTarget smooth(width, height, 4);
    renderer_.draw(named("section"), scene_, smooth, {0, 0, width, height});
    const render::Image averaged = smooth.read();
    double difference = 0.0;
    for (std::size_t i = 0; i < plain.rgba.size(); ++i) {
        difference += std::abs(static_cast<int>(plain.rgba[i]) - static_cast<int>(averaged.rgba[i]));
    }
    // Only edges differ; they are a few per cent of the pixels and by less than full contrast.
    EXPECT_LT(difference / static_cast<double>(plain.rgba.size()), 5.0);
    EXPECT_GT(difference, 0.0);
}

// Reference: the same lights per pixel. Between the vertices of this coarse head the light is not linear:
// some levels, whereas a light that is missing or counted twice makes tens.
TEST_F(SceneRendererTest, VertexLightingMatchesPixelLighting) {
    render::Quality by_vertex = render::qualities().front();
    ASSERT_TRUE(by_vertex.lit_at_vertices);
    render::Quality by_pixel = by_vertex;
    by_pixel.lit_at_vertices = false;
    render::SceneRenderer fast(by_vertex), slow(by_pixel);
    for (const char* name : {"eye", "overview", "section", "laryngoscope"}) {
        const auto drawn = [&](render::SceneRenderer& renderer) {
            renderer.sync(scene_);
            renderer.draw(named(name), scene_, target_, {0, 0, width, height});
            return target_.read();
        };
        const render::Image a = drawn(fast), b = drawn(slow);
        const render::Image ids = picture(named(name), scene_, Shading::object_id);
        double apart = 0.0;
        int tissue = 0;
        for (std::size_t p = 0; p < ids.rgba.size(); p += 4) {
            if (ids.rgba[p] != 0) {
                ++tissue;
                for (std::size_t k = 0; k < 3; ++k) {
                    apart += std::abs(int{a.rgba[p + k]} - int{b.rgba[p + k]}) / 3.0;
                }
            }
        }
        ASSERT_GT(tissue, 500) << name;
        EXPECT_LT(apart / tissue, named(name).lens ? 1e-9 : 4.0) << name;
    }
}

// Reference: the flat triangles. A bend of 0.035 mm is less than a pixel; a gap would show within an organ.
TEST_F(SceneRendererTest, FineOutlinesLeaveNoGaps) {
    render::Quality bent = render::qualities().front();
    bent.fine_outlines = true;
    render::SceneRenderer finer(bent), plain(render::qualities().front());
    int other = 0;
    for (const char* name : {"eye", "overview", "laryngoscope"}) {
        const auto ids = [&](render::SceneRenderer& renderer) {
            renderer.sync(scene_);
            renderer.draw(named(name), scene_, target_, {0, 0, width, height}, {}, Shading::object_id);
            return target_.read();
        };
        const render::Image a = ids(finer), b = ids(plain);
        const auto id = [](const render::Image& image, int x, int y) {
            std::array<std::uint8_t, 3> colour{};
            std::copy_n(&image.rgba[4 * static_cast<std::size_t>(y * width + x)], 3, colour.begin());
            return colour;
        };
        for (int y = 1; y + 1 < height; ++y) {
            for (int x = 1; x + 1 < width; ++x) {
                if (id(a, x, y) == id(b, x, y)) {
                    continue;
                }
                ++other;
                bool at_an_outline = false;
                for (int k = 0; k < 9; ++k) {
                    at_an_outline = at_an_outline || id(b, x + k % 3 - 1, y + k / 3 - 1) != id(b, x, y);
                }
                EXPECT_TRUE(at_an_outline) << name << " at " << x << ", " << y;
            }
        }
    }
    EXPECT_GT(other, 0) << "nothing is bent";
}

// Reference: the skinning code common to server and clients, on the processor.
TEST_F(SceneRendererTest, GpuSkinningMatchesCpu) {
    const auto state = synthetic::deformation(source_, 2'000'000, 0.006f, 0.02f);
    msg::DeformationState turned = state;
    const FramePose pose{source_.rest_centres[1],
                         Quatf(Eigen::AngleAxisf(0.4f, Vec3f(1, 2, 3).normalized()))};
    turned.frames()[1] = bus::encode_frame_pose(1, pose);
    scene_.apply(turned);
    scene_.update();
    renderer_.sync(scene_);
    const auto drawn = renderer_.meshes().patient().vertices();
    float farthest = 0.0f, most_tilted = 0.0f;
    for (const auto& part : renderer_.meshes().patient().parts()) {
        const bus::RestSurface& model = scene_.surfaces().at(part.name).model();
        const auto expected = scene_.surfaces().at(part.name).vertices();
        for (std::size_t v = 0; v < part.vertex_count; ++v) {
            const view::LitVertex& vertex = drawn[part.first_vertex + v];
            const Vec3f skinned = skin_point(model.mesh.vertices[v], model.skin[v], scene_.frame_maps());
            const Vec3f pressed = blade_clearance_for(
                scene_.keys()->laryngoscope(), *scene_.laryngoscope_pose(), scene_.landmarks())(skinned);
            farthest = std::max(farthest, (vertex.position - pressed).norm());
            // Where a vertex and all its neighbours follow one frame, its normal rotates with them.
            if (part.name == "tongue" && pressed == skinned) {
                most_tilted = std::max(most_tilted, (vertex.normal - expected[v].normal).norm());
            }
        }
    }
    // Single precision keeps half a micrometre of 0.1 m over a dozen operations; the requirement is 0.1 mm.
    EXPECT_LT(farthest, 1e-6f);
    EXPECT_LT(most_tilted, 1e-4f);
}

// Displaced surfaces are lit in their displaced position: a normal stays perpendicular to both tangents,
// whose images are known.
TEST_F(SceneRendererTest, NormalsFollowBladeClearanceDeformation) {
    renderer_.sync(scene_);
    const auto drawn = renderer_.meshes().patient().vertices();
    const PosedBladeClearanceDeformer give_way =
        blade_clearance_for(scene_.keys()->laryngoscope(), *scene_.laryngoscope_pose(), scene_.landmarks());
    double turned = 0.0, wrong = 0.0;
    int moved = 0;
    for (const auto& part : renderer_.meshes().patient().parts()) {
        const auto before = scene_.surfaces().at(part.name).vertices();
        for (std::size_t v = 0; v < part.vertex_count; ++v) {
            const Vec3f& place = before[v].position;
            if ((give_way(place) - place).norm() < 0.1e-3f) {
                continue;
            }
            const Vec3f& normal = before[v].normal;
            const auto way = [&](const Vec3f& along) {
                const Vec3f step = 0.05e-3f * along;
                return Vec3f(give_way(place + step) - give_way(place - step));
            };
            const Vec3f aside = normal.unitOrthogonal();
            const Vec3f expected = way(aside).cross(way(normal.cross(aside))).normalized();
            turned += (expected - normal).norm();
            wrong += (expected - drawn[part.first_vertex + v].normal).norm();
            ++moved;
        }
    }
    ASSERT_GT(moved, 20);
    EXPECT_GT(turned / moved, 0.05);
    EXPECT_LT(wrong, 0.25 * turned);
}

// The section shows the inside of throat, larynx and trachea, which are one surface with the skin.
TEST_F(SceneRendererTest, DistinguishesTissuesOfOneSurface) {
    View opened = named("section");
    std::erase(opened.passes, render::Pass::caps);
    const render::Image objects = picture(opened, scene_, Shading::object_id);
    const render::Image tissues = picture(opened, scene_, Shading::tissue_id);
    for (const Tissue lining : {Tissue::larynx, Tissue::trachea}) {
        EXPECT_EQ(count(objects, render::object_colour(lining)), 0);
        EXPECT_GT(count(tissues, render::object_colour(lining)), 50);
    }
    EXPECT_EQ(count(tissues, render::object_colour(Tissue::tongue)),
              count(objects, render::object_colour(Tissue::tongue)));
}

// Drawing uploads only the newest frames and the tube, also in the section: the cut is computed on the
// graphics card.
TEST_F(SceneRendererTest, SectionDrawUploadsNoBuffers) {
    const View& section = named("section");
    (void)picture(section, scene_, Shading::lit);
    scene_.apply(synthetic::deformation(source_, 2'000'000, 0.006f, 0.02f));
    scene_.update();
    renderer_.sync(scene_);
    const auto counted = [](GLenum, GLsizeiptr size, const void*, GLenum) {
        ADD_FAILURE() << size << " bytes sent";
    };
    const auto sends = std::exchange(epoxy_glBufferData, counted);
    renderer_.draw(section, scene_, target_, {0, 0, width, height});
    epoxy_glBufferData = sends;
}

// A lamp in front of the face, seen in the section: the walls of larynx and trachea face it, but lie behind
// the face.
TEST_F(SceneRendererTest, LampIsOccluded) {
    View opened = named("section");
    opened.passes = {render::Pass::lamp_shadow, render::Pass::patient};
    opened.lighting = [](const render::Camera&, const std::optional<render::Light>& lamp) {
        render::Lighting lighting;
        lighting.lights[1] = lamp.value();
        // Beside the handle.
        lighting.lights[1].position = Vec3f(-0.03f, -0.06f, -0.02f);
        lighting.lights[1].direction = Vec3f::UnitY();
        lighting.lights[1].reach = 0.1f;
        lighting.lights[1].colour = Vec3f::Constant(4.0f);
        return lighting;
    };
    const render::Image tissues = picture(opened, scene_, Shading::tissue_id);
    View through = opened;
    std::erase(through.passes, render::Pass::lamp_shadow);
    for (const render::Quality& quality : render::qualities()) {
        render::SceneRenderer renderer(quality);
        renderer.sync(scene_);
        const auto drawn = [&](const View& view) {
            renderer.draw(view, scene_, target_, {0, 0, width, height});
            return target_.read();
        };
        const render::Image without_shadow = drawn(through), with_shadow = drawn(opened);
        int all = 0, lit = 0;
        for (std::size_t i = 0; i < tissues.rgba.size(); i += 4) {
            const std::uint8_t tissue = tissues.rgba[i];
            if ((tissue == render::tissue_label(Tissue::larynx) ||
                 tissue == render::tissue_label(Tissue::trachea)) &&
                without_shadow.rgba[i] > 60) {
                ++all;
                // In sRGB, where a tenth of the light is a third: the share from lit walls.
                lit += 2 * with_shadow.rgba[i] > without_shadow.rgba[i] ? 1 : 0;
            }
        }
        EXPECT_GT(all, 50) << quality.name;
        EXPECT_LT(lit, all / 4) << quality.name;
    }
}

TEST_F(SceneRendererTest, ShowsBackFacesOnRequest) {
    // From within the head every surface of it shows its back.
    View inside = named("overview");
    inside.cameras = [](const view::SceneView&, const render::Vantage&) {
        render::Camera camera;
        camera.eye = Vec3f(0.0f, 0.075f, 0.03f);
        camera.target = Vec3f(0.0f, 0.2f, 0.03f);
        camera.near_plane = 1e-3f;
        return std::vector{camera};
    };
    EXPECT_EQ(count(picture(inside, scene_, Shading::object_id), render::object_colour(Tissue::soft)), 0);
    const render::Image both = picture(inside, scene_, Shading::object_id_both_sides);
    EXPECT_GT(count(both, render::back_colour(Tissue::soft)), width * height / 2);
    const render::Image outside = picture(named("overview"), scene_, Shading::object_id_both_sides);
    EXPECT_EQ(count(outside, render::back_colour(Tissue::soft)), 0);
    EXPECT_EQ(
        count(outside, render::object_colour(Tissue::soft)),
        count(picture(named("overview"), scene_, Shading::object_id), render::object_colour(Tissue::soft)));
}

TEST_F(SceneRendererTest, StereoEyesAreSideBySideWithParallax) {
    const render::Image both = picture(named("stereo"), scene_, Shading::object_id);
    const auto cameras = named("stereo").cameras(scene_, {});
    ASSERT_EQ(cameras.size(), 2u);
    EXPECT_NEAR((cameras[1].eye - cameras[0].eye).norm(), 0.063f, 1e-5f);
    // The right eye sees the blade farther to the left than the left eye does.
    std::array<double, 2> column{}, pixels{};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            if (std::memcmp(both.pixel(x, y), render::blade_colour.data(), 3) == 0) {
                const std::size_t eye = x < width / 2 ? 0 : 1;
                column[eye] += x - static_cast<int>(eye) * width / 2;
                pixels[eye] += 1.0;
            }
        }
    }
    ASSERT_GT(pixels[0], 50);
    ASSERT_GT(pixels[1], 50);
    EXPECT_LT(column[1] / pixels[1], column[0] / pixels[0] - 3.0);
}

TEST_F(SceneRendererTest, EveryQualityLevelDrawsEveryView) {
    for (const render::Quality& quality : render::qualities()) {
        render::SceneRenderer renderer(quality);
        render::RenderTarget target(width, height, quality.samples);
        renderer.sync(scene_);
        for (const View& view : render::views()) {
            renderer.draw(view, scene_, target, {0, 0, width, height});
            const render::Image image = target.read();
            int lit = 0;
            for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
                lit += image.rgba[i] > 60 ? 1 : 0;
            }
            EXPECT_GT(lit, width * height / 20) << quality.name << ", " << view.name;
        }
    }
}

// The vignette darkens a corner but not the middle; fog lifts black.
TEST_F(SceneRendererTest, ToneMappingAppliesVignetteAndFogging) {
    const View& mouth = named("laryngoscope");
    View open = mouth, fogged = mouth;
    open.tone.vignette = 0.0f;
    fogged.tone.fogging = 1.0f;
    const render::Image with = picture(mouth, scene_, Shading::lit),
                        without = picture(open, scene_, Shading::lit),
                        fog = picture(fogged, scene_, Shading::lit);
    EXPECT_EQ(std::memcmp(with.pixel(width / 2, height / 2), without.pixel(width / 2, height / 2), 3), 0);
    double corner_with = 0.0, corner_without = 0.0;
    int darkest = 255;
    for (int y = height - 20; y < height; ++y) {
        for (int x = 0; x < 20; ++x) {
            corner_with += with.pixel(x, y)[0];
            corner_without += without.pixel(x, y)[0];
        }
    }
    EXPECT_LT(corner_with, 0.6 * corner_without);
    for (std::size_t i = 0; i < fog.rgba.size(); i += 4) {
        darkest = std::min<int>(darkest, fog.rgba[i]);
    }
    EXPECT_GT(darkest, 10);
}

// Scene light of a picture's value: inverts sRGB (IEC 61966-2-1) and the film curve (Narkowicz 2015).
double aim_status(std::uint8_t value) {
    const double v = value / 255.0;
    const double y = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    const double a = 2.51 - 2.43 * y, b = 0.03 - 0.59 * y, c = -0.14 * y;
    return (-b + std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
}

double mean_light(const render::Image& image) {
    double sum = 0.0, weights = 0.0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const double out =
                std::hypot((2.0 * x + 1.0) / image.width - 1.0,
                           ((2.0 * y + 1.0) / image.height - 1.0) * image.height / image.width) *
                image.width / image.height;
            const double t = std::clamp((out - 0.75) / 0.7, 0.0, 1.0), weight = 1.0 - t * t * (3.0 - 2.0 * t);
            const std::uint8_t* p = image.pixel(x, y);
            sum +=
                weight * (0.2126 * aim_status(p[0]) + 0.7152 * aim_status(p[1]) + 0.0722 * aim_status(p[2]));
            weights += weight;
        }
    }
    return sum / weights;
}

// Automatic exposure brings a picture that is too bright down to its set point, and changes no other.
TEST_F(SceneRendererTest, ExposureMeteringDarkensBrightPicturesOnly) {
    View plain = named("laryngoscope");
    plain.tone = {};
    const render::Image as_lit = picture(plain, scene_, Shading::lit);
    const double mean = mean_light(as_lit);
    ASSERT_GT(mean, 0.05);

    View metered = plain;
    for (const double share : {0.25, 0.5, 0.75}) {
        metered.tone.metered = static_cast<float>(share * mean);
        EXPECT_NEAR(mean_light(picture(metered, scene_, Shading::lit)), share * mean, 0.05 * share * mean)
            << share;
    }
    metered.tone.metered = static_cast<float>(1.2 * mean);
    EXPECT_EQ(picture(metered, scene_, Shading::lit).rgba, as_lit.rgba);
}

TEST_F(SceneRendererTest, IncompleteSceneDrawsOnlyBackground) {
    view::SceneView partial;
    partial.apply(source_.objects[1]);
    render::SceneRenderer renderer;
    renderer.sync(partial);
    renderer.draw(named("overview"), partial, target_, {0, 0, width, height}, {}, Shading::object_id);
    EXPECT_EQ(count(target_.read(), {0, 0, 0}), width * height);
}

}  // namespace
}  // namespace eti
