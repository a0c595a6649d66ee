// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>
#include <vector>

#include "client/hmd/graphics.hpp"
#include "client/hmd/swapchain.hpp"
#include "client/render/gl_object.hpp"
#include "client/render/render_target.hpp"

namespace eti::hmd {

/// What lies before both eyes: two layers of one picture where the runtime has such, else a picture for each.
class EyeImages {
  public:
    EyeImages(XrSession session, const Graphics& graphics, int eye_width, int eye_height);

    /// Copies both eyes' halves, drawn side by side, left first. Throws CallFailed.
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

/// A flat sheet with text, as drawn.
class PanelImage {
  public:
    PanelImage(XrSession session, const Graphics& graphics, int width, int height);

    /// Throws CallFailed.
    void show(const render::RenderTarget& panel);
    [[nodiscard]] XrSwapchainSubImage image() const { return chain_.layer(0); }

  private:
    const Graphics& graphics_;
    Swapchain chain_;
    render::Framebuffer framebuffer_;
};

}  // namespace eti::hmd
