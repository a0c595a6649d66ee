// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>
#include <vector>

#include "client/hmd/graphics.hpp"
#include "client/hmd/swapchain.hpp"
#include "client/render/gl/gl_object.hpp"
#include "client/render/gl/render_target.hpp"

namespace eti::hmd {

/// Images for both eyes: one two-layer swapchain if the runtime supports it, otherwise one per eye.
class EyeImages {
  public:
    EyeImages(XrSession session, const Graphics& graphics, int eye_width, int eye_height);

    /// Copies both eyes' halves, drawn side by side, left first. Throws OpenXrError.
    void show(const render::RenderTarget& both);
    /// 0: left, 1: right.
    [[nodiscard]] XrSwapchainSubImage of(int eye) const;
    [[nodiscard]] bool layered() const { return chains_.size() == 1; }

  private:
    const Graphics& graphics_;
    int width_, height_;
    std::vector<std::unique_ptr<Swapchain>> chains_;
    render::Framebuffer framebuffer_;
};

/// Image of a flat quad with text.
class QuadImage {
  public:
    QuadImage(XrSession session, const Graphics& graphics, int width, int height);

    /// Copies the panel's picture. Throws OpenXrError.
    void show(const render::RenderTarget& panel);
    [[nodiscard]] XrSwapchainSubImage image() const { return chain_.layer(0); }

  private:
    const Graphics& graphics_;
    Swapchain chain_;
    render::Framebuffer framebuffer_;
};

}  // namespace eti::hmd
