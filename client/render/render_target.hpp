// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

#include "client/render/gl_object.hpp"
#include "client/render/image.hpp"
#include "client/render/viewport.hpp"

namespace eti::render {

/// Where pictures are made: a scene of linear light (16-bit floats, depth and stencil) and the sRGB picture
/// that is made of it. With `samples` over one the scene's edges are smoothed.
class RenderTarget {
  public:
    /// Throws std::runtime_error when the driver refuses the size.
    RenderTarget(int width, int height, int samples);

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }

    /// Draw the scene here.
    void bind_scene() const;
    /// Averages the samples of an area of the scene into light().
    void resolve(const Viewport& area) const;
    [[nodiscard]] const Texture& light() const { return light_; }
    /// Draw here what becomes the picture, and overlays on it.
    void bind_picture() const;
    /// The picture has the scene's depths, so that what drew nothing can be told: only without more samples.
    [[nodiscard]] bool picture_has_depth() const { return !sampled_; }
    /// Reads the picture back; waits for the driver.
    [[nodiscard]] Image read() const;
    /// Copies an area of the picture into one of a framebuffer (0: a window's), as large or scaled.
    void copy_to(GLuint framebuffer, const Viewport& from, const Viewport& to) const;

  private:
    struct Sampled {
        Framebuffer framebuffer;
        Renderbuffer light;
    };

    int width_;
    int height_;
    Framebuffer picture_, scene_;
    Renderbuffer picture_colour_, depth_stencil_;
    Texture light_;
    std::optional<Sampled> sampled_;
};

/// Gives a texture room for linear light of `width` x `height` pixels, and a framebuffer it to draw into.
/// Both stay bound.
void store_light(const Texture& texture, const Framebuffer& framebuffer, int width, int height);

}  // namespace eti::render
