// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

#include "client/render/gl/gl_object.hpp"
#include "client/render/image.hpp"
#include "client/render/views/viewport.hpp"

namespace eti::render {

/// Target of a picture: the scene in linear light (16-bit floats, depth and stencil) and the sRGB picture
/// made from it. With `samples` above one the scene is multisampled.
class RenderTarget {
  public:
    /// Throws std::runtime_error if the driver rejects the size.
    RenderTarget(int width, int height, int samples);

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }

    /// Binds the framebuffer for the scene.
    void bind_scene() const;
    /// Resolves the samples of an area of the scene into light().
    void resolve(const Viewport& area) const;
    [[nodiscard]] const Texture& light() const { return light_; }
    /// Binds the framebuffer for the final picture and its overlays.
    void bind_picture() const;
    /// Whether the picture shares the scene's depth, so that background pixels can be identified: only
    /// without multisampling.
    [[nodiscard]] bool picture_has_depth() const { return !sampled_; }
    /// Reads the picture back; waits for the driver.
    [[nodiscard]] Image read() const;
    /// Blits an area of the picture to an area of a framebuffer (0: a window's), scaled if necessary.
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

/// Allocates a texture of `width` x `height` pixels for linear light and attaches it to a framebuffer. Both
/// stay bound.
void allocate_hdr_target(const Texture& texture, const Framebuffer& framebuffer, int width, int height);

}  // namespace eti::render
