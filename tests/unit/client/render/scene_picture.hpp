// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string_view>

#include "client/render/gl/headless_context.hpp"
#include "client/render/gl/render_target.hpp"
#include "client/render/scene_renderer.hpp"
#include "synthetic_scene.hpp"

namespace eti::test {

using Colour = std::array<std::uint8_t, 3>;

inline constexpr int width = 320, height = 240;

inline const render::View& named(std::string_view name) {
    return *render::view_named(name);
}

/// The synthetic scene, and pictures of it.
class ScenePicture : public ::testing::Test {
  protected:
    [[nodiscard]] render::Image picture(const render::View& view, const view::SceneView& scene,
                                        render::Shading shading) {
        renderer_.sync(scene);
        // Hands would cover what the tests compare.
        renderer_.draw(view, scene, target_, {0, 0, width, height}, {.hands = false}, shading);
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

}  // namespace eti::test
