// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/passes/liquid/liquid_surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "common/bus/codec/fluid_state.hpp"
#include "scene_picture.hpp"

namespace eti {
namespace {

using render::Shading;
using render::View;
using test::Colour;
using test::height;
using test::named;
using test::width;
using LiquidPicture = test::ScenePicture;

struct OnPicture {
    Eigen::Vector2f pixel;
    float pixels_per_metre;
};

OnPicture on_picture(const View& view, const view::SceneView& scene, const Vec3f& place) {
    const render::Camera camera = view.camera(scene, {});
    const Eigen::Matrix4f projection = camera.projection(static_cast<float>(width) / height) * camera.view();
    const Eigen::Vector4f clip = projection * place.homogeneous();
    return {{0.5f * width * (1.0f + clip.x() / clip.w()), 0.5f * height * (1.0f - clip.y() / clip.w())},
            0.5f * height * projection.block<1, 3>(1, 0).norm() / clip.w()};
}

std::vector<Eigen::Vector2f> differing_pixels(const render::Image& a, const render::Image& b) {
    std::vector<Eigen::Vector2f> pixels;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            if (std::memcmp(a.pixel(x, y), b.pixel(x, y), 3) != 0) {
                pixels.emplace_back(static_cast<float>(x), static_cast<float>(y));
            }
        }
    }
    return pixels;
}

float farthest(const std::vector<Eigen::Vector2f>& pixels, const Eigen::Vector2f& from) {
    float most = 0.0f;
    for (const Eigen::Vector2f& pixel : pixels) {
        most = std::max(most, (pixel - from).norm());
    }
    return most;
}

TEST_F(LiquidPicture, LiquidChangesOnlyItsOwnPixels) {
    // A drop of 5 mm in front of the mouth, on the half that the section keeps.
    view::SceneView wet = scene_;
    const Vec3f before_mouth = at(scene_.landmarks(), Landmark::mouth_opening) + Vec3f(-0.01f, -0.02f, 0.0f);
    std::vector<Vec3f> drop;
    for (int k = 0; k < 5 * 5 * 5; ++k) {
        drop.push_back(before_mouth + 1e-3f * Eigen::Vector3i(k % 5, k / 5 % 5, k / 25).cast<float>());
    }
    msg::FluidState message;
    bus::encode_fluid_chunk({Vec3f::Constant(-0.1f), Vec3f::Constant(0.1f), 1e-3f, drop}, 0, message);
    ASSERT_TRUE(wet.apply(message));
    wet.update();
    for (const View& view : render::views()) {
        if (view.cameras(wet, {}).size() > 1 || view.lens) {
            continue;  // two half pictures, each drawn as that of one camera; and the drop lies behind the
                       // lens
        }
        const render::Image dry_picture = picture(view, scene_, Shading::lit);
        const render::Image wet_picture = picture(view, wet, Shading::lit);
        const OnPicture middle = on_picture(view, wet, drop.front() + Vec3f::Constant(2e-3f));
        // Half the drop's diagonal and a sphere beyond it.
        const float reach = 7e-3f * middle.pixels_per_metre + 2.0f;
        const auto changed = differing_pixels(dry_picture, wet_picture);
        EXPECT_LT(farthest(changed, middle.pixel), reach) << view.name;
        // At least a sixth of the square of the drop's outer particles: the rest may be hidden.
        EXPECT_GT(static_cast<float>(changed.size()), std::pow(4e-3f * middle.pixels_per_metre, 2.0f) / 6.0f)
            << view.name;
    }
    // Measurements on flat colours are unaffected.
    EXPECT_EQ(picture(named("section"), scene_, Shading::object_id).rgba,
              picture(named("section"), wet, Shading::object_id).rgba);
}

// A particle represents a cube of its spacing: alone it is a sphere of that volume, 0.62 spacings in radius.
TEST_F(LiquidPicture, SingleDropHasParticleVolume) {
    constexpr float spacing = 6e-3f;
    const View& view = named("overview");
    msg::SessionDescription description = source_.description;
    description.liquid("blood");  // every pixel of it counts
    view::SceneView wet = scene_;
    wet.apply(description);
    const Vec3f place = at(scene_.landmarks(), Landmark::mouth_opening) + Vec3f(-0.01f, -0.02f, 0.0f);
    msg::FluidState message;
    bus::encode_fluid_chunk({Vec3f::Constant(-0.1f), Vec3f::Constant(0.1f), spacing, std::vector{place}}, 0,
                            message);
    ASSERT_TRUE(wet.apply(message));
    wet.update();
    const render::Image dry = picture(view, scene_, Shading::lit);
    const render::Image drop = picture(view, wet, Shading::lit);
    const std::size_t changed = differing_pixels(dry, drop).size();
    const float radius = 0.62f * spacing * on_picture(view, wet, place).pixels_per_metre;
    const float area = 3.14159f * radius * radius;
    EXPECT_NEAR(static_cast<float>(changed), area, 0.2f * area + 3.14159f * radius) << "half a pixel of rim";
}

// Two drops that collide in front of the mouth and separate: foam and filaments appear around the liquid
// only, and vanish once nothing has moved for longer than a bubble's lifetime.
TEST_F(LiquidPicture, FoamAndFilamentsAppearOnlyNearLiquid) {
    const View& view = named("section");  // without the room, whose monitor changes with time
    const Vec3f mouth = at(scene_.landmarks(), Landmark::mouth_opening) + Vec3f(-0.01f, -0.02f, 0.0f);
    view::SceneView wet = scene_;
    std::uint64_t time_ns = wet.simulation_time_ns();
    const auto state = [&](float gap) {
        std::vector<Vec3f> drops;
        for (int k = 0; k < 2 * 5 * 5 * 5; ++k) {
            const Vec3f side(k < 125 ? -gap - 5e-3f : gap, 0.0f, 0.0f);
            drops.push_back(mouth + side +
                            1e-3f * Eigen::Vector3i(k % 5, k / 5 % 5, k / 25 % 5).cast<float>());
        }
        time_ns += 11'111'111;
        msg::FluidState message;
        for (std::size_t chunk = 0; chunk < bus::fluid_chunk_count(drops.size()); ++chunk) {
            bus::encode_fluid_chunk({Vec3f::Constant(-0.1f), Vec3f::Constant(0.1f), 1e-3f, drops}, chunk,
                                    message);
            message.header().simulation_time_ns(time_ns);
            ASSERT_TRUE(wet.apply(message));
        }
    };
    for (int s = 0; s <= 16; ++s) {
        state(4e-3f - 0.25e-3f * static_cast<float>(s));
    }
    for (int s = 1; s <= 12; ++s) {
        state(0.25e-3f * static_cast<float>(s));
    }
    state(3e-3f);
    wet.update();
    ASSERT_GT(wet.liquid_detail().foam().bubbles().size(), 20u);
    ASSERT_GT(wet.liquid_detail().filaments().filaments().size(), 2u);
    const render::Image frothy = picture(view, wet, Shading::lit);
    // The same positions without a history.
    const std::vector<Vec3f> places(wet.liquid().begin(), wet.liquid().end());
    view::SceneView still = scene_;
    msg::FluidState message;
    for (std::size_t chunk = 0; chunk < bus::fluid_chunk_count(places.size()); ++chunk) {
        bus::encode_fluid_chunk({Vec3f::Constant(-0.1f), Vec3f::Constant(0.1f), 1e-3f, places}, chunk,
                                message);
        ASSERT_TRUE(still.apply(message));
    }
    still.update();
    const render::Image plain = picture(view, still, Shading::lit);
    const OnPicture middle = on_picture(view, wet, mouth);
    const auto changed = differing_pixels(frothy, plain);
    EXPECT_LT(farthest(changed, middle.pixel), 16e-3f * middle.pixels_per_metre);
    EXPECT_GT(changed.size(), 20u);
    for (int s = 0; s < 90 * 10; ++s) {
        state(3e-3f);
    }
    wet.update();
    EXPECT_TRUE(wet.liquid_detail().foam().bubbles().empty());
    EXPECT_TRUE(wet.liquid_detail().filaments().filaments().empty());
    EXPECT_EQ(picture(view, wet, Shading::lit).rgba, plain.rgba);
}

// Beer-Lambert: blood transmits red, and almost no green and blue; saliva transmits all alike.
TEST_F(LiquidPicture, BloodIsDarkRed) {
    const View& view = named("overview");
    const Vec3f corner = at(scene_.landmarks(), Landmark::mouth_opening) + Vec3f(-0.01f, -0.02f, 0.0f);
    std::vector<Vec3f> drop;
    for (int k = 0; k < 7 * 7 * 7; ++k) {
        drop.push_back(corner + 1e-3f * Eigen::Vector3i(k % 7, k / 7 % 7, k / 49).cast<float>());
    }
    const auto middle = [&](const char* liquid) {
        msg::SessionDescription description = source_.description;
        description.liquid(std::string(liquid));
        view::SceneView scene = scene_;
        scene.apply(description);
        msg::FluidState message;
        for (std::size_t chunk = 0; chunk < bus::fluid_chunk_count(drop.size()); ++chunk) {
            bus::encode_fluid_chunk({Vec3f::Constant(-0.1f), Vec3f::Constant(0.1f), 1e-3f, drop}, chunk,
                                    message);
            EXPECT_TRUE(scene.apply(message));
        }
        scene.update();
        const render::Image image = picture(view, scene, Shading::lit);
        const render::Camera camera = view.camera(scene, {});
        const Eigen::Vector4f clip = camera.projection(static_cast<float>(width) / height) * camera.view() *
                                     (corner + Vec3f::Constant(3e-3f)).homogeneous();
        const std::uint8_t* p = image.pixel(static_cast<int>(0.5f * width * (1.0f + clip.x() / clip.w())),
                                            static_cast<int>(0.5f * height * (1.0f - clip.y() / clip.w())));
        return Colour{p[0], p[1], p[2]};
    };
    const Colour saliva = middle("saliva"), blood = middle("blood");
    EXPECT_GT(blood[0], 2 * blood[1]);
    EXPECT_GT(blood[0], 2 * blood[2]);
    EXPECT_GT(blood[0], 40) << "red, not black";
    EXPECT_LT(blood[0], saliva[0]);
    EXPECT_LT(saliva[0], 1.5 * saliva[1]) << "of no colour of its own";
}

// Beer-Lambert: a film of blood transmits what lies behind, a deep pool of it nothing.
TEST_F(LiquidPicture, DeepBloodHidesMoreThanFilm) {
    const View& view = named("overview");
    const Vec3f mouth = at(scene_.landmarks(), Landmark::mouth_opening) + Vec3f(-0.01f, -0.02f, 0.0f);
    msg::SessionDescription description = source_.description;
    description.liquid("blood");
    const auto middle = [&](int layers, float spacing) {
        std::vector<Vec3f> pool;
        for (int k = 0; k < 24 * 24 * layers; ++k) {
            pool.push_back(mouth +
                           spacing * Eigen::Vector3i(k % 24 - 12, k / 576, k / 24 % 24 - 12).cast<float>());
        }
        view::SceneView scene = scene_;
        scene.apply(description);
        msg::FluidState message;
        for (std::size_t chunk = 0; !pool.empty() && chunk < bus::fluid_chunk_count(pool.size()); ++chunk) {
            bus::encode_fluid_chunk({Vec3f::Constant(-0.1f), Vec3f::Constant(0.1f), spacing, pool}, chunk,
                                    message);
            EXPECT_TRUE(scene.apply(message));
        }
        scene.update();
        const render::Image image = picture(view, scene, Shading::lit);
        const Eigen::Vector2f place = on_picture(view, scene, mouth).pixel;
        const std::uint8_t* p = image.pixel(static_cast<int>(place.x()), static_cast<int>(place.y()));
        return Colour{p[0], p[1], p[2]};
    };
    // One layer of 0.1 mm; six of 0.5 mm.
    const Colour bare = middle(0, 1e-4f), film = middle(1, 1e-4f), pool = middle(6, 5e-4f);
    EXPECT_LT(2 * std::abs(film[0] - bare[0]), std::abs(pool[0] - bare[0]));
    EXPECT_GT(pool[0], 2 * pool[1]) << "only red is left";
}

// Drops of blood between lamp and skin darken skin beside themselves; saliva is too clear.
TEST_F(LiquidPicture, DropsOfBloodCastShadows) {
    const View& view = named("overview");
    constexpr float spacing = 6e-3f, apart = 18e-3f;  // [m]
    const Vec3f above_mouth = at(scene_.landmarks(), Landmark::mouth_opening) + Vec3f(0.0f, -0.022f, 0.0f);
    std::vector<Vec3f> drops;
    for (int k = 0; k < 25; ++k) {
        drops.push_back(above_mouth + apart * Eigen::Vector3i(k % 5 - 2, 0, k / 5 - 2).cast<float>());
    }
    const auto darker_beside = [&](const char* liquid) {
        msg::SessionDescription description = source_.description;
        description.liquid(std::string(liquid));
        view::SceneView wet = scene_;
        wet.apply(description);
        msg::FluidState message;
        bus::encode_fluid_chunk({Vec3f::Constant(-0.2f), Vec3f::Constant(0.2f), spacing, drops}, 0, message);
        EXPECT_TRUE(wet.apply(message));
        wet.update();
        const render::Image dry = picture(view, scene_, Shading::lit),
                            image = picture(view, wet, Shading::lit);
        int darker = 0;
        for (const Eigen::Vector2f& p : differing_pixels(dry, image)) {
            const bool outside = std::ranges::all_of(drops, [&](const Vec3f& drop) {
                const OnPicture middle = on_picture(view, wet, drop);
                return (p - middle.pixel).norm() > 0.62f * spacing * middle.pixels_per_metre + 2.0f;
            });
            const int x = static_cast<int>(p.x()), y = static_cast<int>(p.y());
            darker += outside && image.pixel(x, y)[0] < dry.pixel(x, y)[0] ? 1 : 0;
        }
        return darker;
    };
    EXPECT_GT(darker_beside("blood"), 10);
    EXPECT_EQ(darker_beside("saliva"), 0);
}

// Surfaces touched by liquid stay wet, dry with a time constant of 25 s, and are dry where there was none.
TEST_F(LiquidPicture, LiquidLeavesDryingFilm) {
    const View& view = named("overview");
    const Vec3f mouth = at(scene_.landmarks(), Landmark::mouth_opening);
    const auto state = [&](view::SceneView& scene, double seconds, bool any) {
        std::vector<Vec3f> pool;
        for (int k = 0; any && k < 60 * 60; ++k) {
            pool.push_back(mouth + 1e-3f * Vec3f(static_cast<float>(k % 60 - 30), 0.0f,
                                                 static_cast<float>(k / 60 - 30)));
        }
        msg::FluidState message;
        for (std::size_t chunk = 0; chunk < bus::fluid_chunk_count(pool.size()); ++chunk) {
            bus::encode_fluid_chunk({Vec3f::Constant(-0.2f), Vec3f::Constant(0.2f), 1e-3f, pool}, chunk,
                                    message);
            message.header().simulation_time_ns(static_cast<std::uint64_t>(1e9 * seconds));
            ASSERT_TRUE(scene.apply(message));
        }
        scene.update();
        renderer_.sync(scene);
    };
    const render::Image dry = picture(view, scene_, Shading::lit);
    EXPECT_FALSE(renderer_.meshes().patient().has_film()) << "what was never wet costs nothing";
    view::SceneView wet = scene_;
    state(wet, 1.0, true);
    const std::vector<float> at_first = renderer_.film().values();
    const std::vector<view::LitVertex> vertices = renderer_.meshes().patient().vertices();
    ASSERT_EQ(at_first.size(), vertices.size());
    int beneath = 0;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        const Vec3f apart = vertices[v].position - mouth;
        if (apart.cwiseAbs().maxCoeff() < 28e-3f && std::abs(apart.y()) < 0.4e-3f) {
            EXPECT_GT(at_first[v], 0.9f);
            ++beneath;
        } else if (std::abs(apart.y()) > 3e-3f || apart.norm() > 50e-3f) {
            EXPECT_EQ(at_first[v], 0.0f);
        }
    }
    EXPECT_GT(beneath, 10);
    state(wet, 11.0, false);
    const std::vector<float> later = renderer_.film().values();
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        EXPECT_NEAR(later[v], at_first[v] * std::exp(-10.0f / 25.0f), 1e-4f);
    }
    const render::Image filmed = picture(view, wet, Shading::lit);
    EXPECT_NE(filmed.rgba, dry.rgba);
    // Measurements on flat colours are unaffected.
    EXPECT_EQ(picture(view, wet, Shading::object_id).rgba, picture(view, scene_, Shading::object_id).rgba);
}

}  // namespace
}  // namespace eti
