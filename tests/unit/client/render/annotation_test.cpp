// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <epoxy/gl.h>
#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "client/render/passes/annotation_pass.hpp"
#include "client/render/views/pick.hpp"
#include "client/view/sight/line_of_sight.hpp"
#include "scene_picture.hpp"
#include "tests/support/error_of.hpp"

namespace eti::render {
namespace {

using test::height;
using test::named;
using test::width;

constexpr float aspect = static_cast<float>(width) / static_cast<float>(height);

class Pick : public test::ScenePicture {
  protected:
    [[nodiscard]] static std::optional<PickHit> at(const View& view, const view::SceneView& scene, int x,
                                                   int y) {
        return pick(view, scene, {}, aspect, 2.0f * (static_cast<float>(x) + 0.5f) / width - 1.0f,
                    1.0f - 2.0f * (static_cast<float>(y) + 0.5f) / height);
    }
    // Colour that the pixel at (x, y) and all its neighbours show; none at an edge, where half a pixel
    // counts.
    [[nodiscard]] static std::optional<test::Colour> shown(const Image& ids, int x, int y) {
        const std::uint8_t* const p = ids.pixel(x, y);
        for (int j = y - 1; j <= y + 1; ++j) {
            for (int i = x - 1; i <= x + 1; ++i) {
                if (!std::equal(p, p + 3, ids.pixel(i, j))) {
                    return std::nullopt;
                }
            }
        }
        return test::Colour{p[0], p[1], p[2]};
    }
    static std::string name_of_colour(const test::Colour& colour) {
        if (colour == blade_colour) {
            return "blade";
        }
        if (colour == tube_colour) {
            return "tube";
        }
        for (std::size_t i = 0; i < tissue_count; ++i) {
            if (colour == object_colour(static_cast<Tissue>(i))) {
                return std::string(name_of(static_cast<Tissue>(i)));
            }
        }
        return "nothing";
    }
};

// Against the driver's own picture, by the tissue buffer.
TEST_F(Pick, NamesTissueShownAtPixel) {
    for (const char* name : {"overview", "eye", "laryngoscope"}) {
        const View& view = named(name);
        const Image ids = picture(view, scene_, Shading::tissue_id);
        std::map<std::string, int> seen;
        for (int y = 5; y < height - 5; y += 11) {
            for (int x = 5; x < width - 5; x += 11) {
                const auto colour = shown(ids, x, y);
                if (!colour) {
                    continue;
                }
                const std::string drawn = name_of_colour(*colour);
                const auto picked = at(view, scene_, x, y);
                EXPECT_EQ(picked ? std::string(picked->name) : "nothing", drawn)
                    << name << " at " << x << ", " << y;
                ++seen[drawn];
            }
        }
        EXPECT_GE(seen.size(), 3u) << name;
    }
}

// The dot of the gaze onto the glottis does so, too, for any position of the eye.
TEST_F(Pick, GazeDotNamesTissueShownAtPixel) {
    const View& view = named("eye");
    std::map<std::string, int> seen;
    for (const float across : {-0.08f, -0.03f, -0.012f, -0.004f, 0.003f, 0.01f, 0.025f, 0.07f}) {
        for (const float along : {-0.05f, 0.0f, 0.04f, 0.09f}) {
            Vantage from;
            from.eye = view::TraineeEye(Vec3f(across, 0.0f, along));
            const view::LineOfSight look = view::trace_line_of_sight(scene_, from.eye);
            renderer_.sync(scene_);
            renderer_.draw(view, scene_, target_, {0, 0, width, height}, from, Shading::tissue_id);
            const Image ids = target_.read();
            const Camera camera = view.camera(scene_, from);
            const Vec3f end = look.obstacle ? look.obstacle->position : look.sight.to;
            const Vec3f clip =
                (camera.projection(aspect) * camera.view() * end.homogeneous()).eval().hnormalized();
            const int x = static_cast<int>(0.5f * width * (1.0f + clip.x()));
            const int y = static_cast<int>(0.5f * height * (1.0f - clip.y()));
            ASSERT_TRUE(x > 0 && x < width - 1 && y > 0 && y < height - 1) << across << ", " << along;
            const auto colour = shown(ids, x, y);
            if (!look.obstacle || !colour) {
                continue;
            }
            const std::string named_by_colour = name_of_colour(*colour);
            const std::string drawn = named_by_colour == "soft" ? "soft tissue" : named_by_colour;
            EXPECT_EQ(std::string(look.obstacle->name), drawn)
                << "an eye moved by " << across << ", " << along;
            ++seen[drawn];
        }
    }
    EXPECT_GE(seen.size(), 2u);
}

// The picked point lies where it is seen: it projects onto the pixel, and its triangle and height lead back
// to it.
TEST_F(Pick, PickedPointProjectsOntoPixel) {
    for (const char* name : {"overview", "section"}) {
        const View& view = named(name);
        const Camera camera = view.camera(scene_, {});
        const Eigen::Matrix4f matrix = camera.projection(aspect) * camera.view();
        int places = 0;
        for (int y = 10; y < height; y += 20) {
            for (int x = 10; x < width; x += 20) {
                const auto picked = at(view, scene_, x, y);
                if (!picked || picked->object.empty()) {
                    continue;
                }
                ++places;
                const Vec3f clip = (matrix * picked->position.homogeneous()).eval().hnormalized();
                EXPECT_NEAR(0.5f * width * (1.0f + clip.x()), static_cast<float>(x) + 0.5f, 0.2f) << name;
                EXPECT_NEAR(0.5f * height * (1.0f - clip.y()), static_cast<float>(y) + 0.5f, 0.2f) << name;
                const auto now = view::current_position(scene_, picked->object, picked->place);
                ASSERT_TRUE(now);
                EXPECT_LT((*now - picked->position).norm(), 0.05e-3f) << name << " " << x << ", " << y;
            }
        }
        EXPECT_GT(places, 20) << name;
    }
}

TEST_F(Pick, SectionFacePicksCutOrgan) {
    const View& view = named("section");
    const Image ids = picture(view, scene_, Shading::object_id);
    std::map<std::string, int> met;
    int apart = 0, compared = 0;
    for (int y = 5; y < height - 5; y += 6) {
        for (int x = 5; x < width - 5; x += 6) {
            const auto colour = shown(ids, x, y);
            const auto picked = at(view, scene_, x, y);
            if (!colour || !picked || picked->object.empty() ||
                std::abs(picked->position.x()) > 1e-6f) {  // not on the face
                continue;
            }
            ++compared;
            const auto* const surface = scene_.rest_surface(picked->object);
            ASSERT_NE(surface, nullptr);
            ++met[picked->object];
            apart += *colour != object_colour(surface->tissue) ? 1 : 0;
        }
    }
    EXPECT_GT(compared, 100);
    EXPECT_LT(apart, compared / 100) << "the blade before the cut hides some";
    EXPECT_TRUE(met.contains("tongue") && met.contains("body") && met.contains("spine"));
}

class AnnotationPicture : public Pick {
  protected:
    // An annotation point on the surface seen at (x, y) of a view.
    void mark(const View& view, int x, int y, const std::string& text = "") {
        const auto picked = at(view, scene_, x, y);
        ASSERT_TRUE(picked && !picked->object.empty());
        where_ = picked->position;
        msg::ShownAnnotation shown;
        shown.what().kind(msg::ANNOTATION_POINT);
        shown.what().text(text);
        shown.what().object(picked->object);
        msg::SurfacePlace& place = shown.what().places().emplace_back();
        place.triangle(picked->place.triangle);
        place.u(picked->place.u);
        place.v(picked->place.v);
        place.height(picked->place.height);
        ASSERT_TRUE(scene_.apply(shown));
    }
    // Number of pixels that have become bluer, their centre, and the largest change.
    struct Bluer {
        int count = 0, most = 0;
        Eigen::Vector2f middle = Eigen::Vector2f::Zero();
    };
    static Bluer bluer(const Image& before, const Image& after) {
        Bluer out;
        for (int y = 0; y < after.height; ++y) {
            for (int x = 0; x < after.width; ++x) {
                const int by = after.pixel(x, y)[2] - before.pixel(x, y)[2];
                out.most = std::max(out.most, by);
                if (by > 60) {
                    ++out.count;
                    out.middle += Eigen::Vector2f(static_cast<float>(x), static_cast<float>(y));
                }
            }
        }
        out.middle /= static_cast<float>(std::max(out.count, 1));
        return out;
    }
    Vec3f where_ = Vec3f::Zero();
};

TEST_F(AnnotationPicture, PointIsDrawnAtPickedPixel) {
    for (const char* name : {"overview", "section"}) {
        const View& view = named(name);
        const Image plain = picture(view, scene_, Shading::lit);
        const Image ids = picture(view, scene_, Shading::object_id);
        // On a pixel that is neither tube nor blade nor background.
        std::pair<int, int> pixel{0, 0};
        for (int y = height / 3; y < height && pixel.first == 0; y += 5) {
            for (int x = width / 3; x < width && pixel.first == 0; x += 5) {
                const auto picked = at(view, scene_, x, y);
                const auto around = at(view, scene_, x + 8, y + 8), before = at(view, scene_, x - 8, y - 8);
                if (picked && around && before && picked->object == "body" && around->object == "body" &&
                    before->object == "body") {
                    pixel = {x, y};
                }
            }
        }
        ASSERT_GT(pixel.first, 0) << name;
        mark(view, pixel.first, pixel.second);
        const Bluer marked = bluer(plain, picture(view, scene_, Shading::lit));
        EXPECT_GT(marked.count, 20) << name;
        const Eigen::Vector2f there(static_cast<float>(pixel.first), static_cast<float>(pixel.second));
        EXPECT_LT((marked.middle - there).norm(), 2.0f) << name;
        EXPECT_EQ(picture(view, scene_, Shading::object_id).rgba, ids.rgba)
            << "pictures are measured without marks";
        msg::ShownAnnotation wiped;
        wiped.what().kind(msg::ANNOTATION_CLEAR);
        ASSERT_TRUE(scene_.apply(wiped));
        EXPECT_EQ(picture(view, scene_, Shading::lit).rgba, plain.rgba) << name;
    }
}

TEST_F(AnnotationPicture, OccludedMarkIsDrawnFaintly) {
    // The tongue's middle, in the mouth, as the onlooker sees it through the cheek.
    msg::ShownAnnotation shown;
    shown.what().kind(msg::ANNOTATION_POINT);
    shown.what().object("tongue");
    shown.what().places().emplace_back().u(0.3f);
    const View& overview = named("overview");
    const Image plain = picture(overview, scene_, Shading::lit);
    ASSERT_TRUE(scene_.apply(shown));
    const Image marked = picture(overview, scene_, Shading::lit);
    const Bluer faint = bluer(plain, marked);
    EXPECT_GT(faint.most, 15);
    EXPECT_LT(faint.most, 130) << "half-way to what it is in the open";
}

TEST_F(AnnotationPicture, StrokeSpansFirstToLastPoint) {
    const View& section = named("section");
    msg::ShownAnnotation shown;
    shown.what().kind(msg::ANNOTATION_STROKE);
    shown.what().object("body");
    for (int x = 60; x <= 260; x += 4) {
        const auto picked = at(section, scene_, x, 110);
        if (picked && picked->object == "body" && shown.what().places().size() < 48) {
            msg::SurfacePlace& place = shown.what().places().emplace_back();
            place.triangle(picked->place.triangle);
            place.u(picked->place.u);
            place.v(picked->place.v);
            place.height(picked->place.height);
        }
    }
    ASSERT_GE(shown.what().places().size(), 4u);
    ASSERT_TRUE(scene_.apply(shown));
    const auto marks = drawn_marks(section, scene_, {});
    ASSERT_EQ(marks.size(), 1u);
    const Image drawn = picture(section, scene_, Shading::lit);
    const Camera camera = section.camera(scene_, {});
    const Eigen::Matrix4f matrix = camera.projection(aspect) * camera.view();
    for (const Vec3f& point : marks[0].points) {
        const Vec3f clip = (matrix * point.homogeneous()).eval().hnormalized();
        const std::uint8_t* const p = drawn.pixel(static_cast<int>(0.5f * width * (1.0f + clip.x())),
                                                  static_cast<int>(0.5f * height * (1.0f - clip.y())));
        EXPECT_GT(p[2] - p[0], 90);
    }
}

TEST_F(AnnotationPicture, MarkOnRemovedHalfIsNotDrawn) {
    // A point on the patient's left cheek, which the section cuts away.
    const View& section = named("section");
    const auto& body = *scene_.rest_surface("body");
    for (std::uint32_t t = 0; t < body.mesh.triangles.size(); ++t) {
        const float x = body.mesh.vertices[body.mesh.triangles[t][0]].x();
        if (std::abs(x) > 0.02f) {
            msg::ShownAnnotation shown;
            shown.what().kind(msg::ANNOTATION_POINT);
            shown.what().object("body");
            shown.what().places().emplace_back().triangle(t);
            ASSERT_TRUE(scene_.apply(shown));
            EXPECT_EQ(drawn_marks(section, scene_, {}).size(), x > 0.0f ? 0u : 1u) << x;
            EXPECT_EQ(drawn_marks(named("overview"), scene_, {}).size(), 1u);
        }
    }
}

// epoxy's entry points are variables: this simulates a driver after a GPU reset without a graphics card.
TEST_F(AnnotationPicture, GpuResetIsReported) {
    const auto driver = epoxy_glGetGraphicsResetStatus;
    ASSERT_NO_THROW(renderer_.sync(scene_));
    epoxy_glGetGraphicsResetStatus = []() -> GLenum { return GL_INNOCENT_CONTEXT_RESET; };
    EXPECT_THAT(test::error_of<std::runtime_error>([&] { renderer_.sync(scene_); }),
                ::testing::AllOf(::testing::HasSubstr("reset, caused by another program"),
                                 ::testing::HasSubstr("LIBGL_ALWAYS_SOFTWARE")));
    epoxy_glGetGraphicsResetStatus = driver;
    EXPECT_NO_THROW(renderer_.sync(scene_));
}

}  // namespace
}  // namespace eti::render
