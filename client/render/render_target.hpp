// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

#include "client/render/gl_object.hpp"
#include "client/render/image.hpp"

namespace eti::render {

/// An off-screen picture: sRGB colour with depth and stencil. With `samples` over one, edges are
/// smoothed; resolve() then brings the result into the plain picture, on which an overlay may be drawn.
class RenderTarget {
  public:
    /// Throws std::runtime_error when the driver refuses the size.
    RenderTarget(int width, int height, int samples);

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }

    /// Draw the scene here.
    void bind_scene() const;
    /// Averages the samples and binds the plain picture.
    void resolve() const;
    /// Reads the plain picture back; waits for the driver.
    [[nodiscard]] Image read() const;
    /// Copies the plain picture into framebuffer 0 (a window's).
    void copy_to_window() const;

  private:
    int width_;
    int height_;
    Framebuffer plain_;
    Renderbuffer plain_colour_;
    Renderbuffer depth_stencil_;
    std::optional<Framebuffer> sampled_;
    std::optional<Renderbuffer> sampled_colour_;
};

}  // namespace eti::render
