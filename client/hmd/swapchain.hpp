// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <epoxy/gl.h>

#include <cstdint>
#include <vector>

#include "client/hmd/xr.hpp"

namespace eti::hmd {

/// Pictures that the runtime shows in turn: sRGB, of one layer or several.
class Swapchain {
  public:
    /// Throws CallFailed: XR_ERROR_FEATURE_UNSUPPORTED where the runtime has no pictures of several layers.
    Swapchain(XrSession session, int width, int height, int layers);

    /// Waits for a picture that may be drawn into. Throws CallFailed.
    void acquire();
    /// What was drawn into it is what the next frame shows.
    void release();
    /// Attaches a layer of the acquired picture to the framebuffer that is bound for drawing.
    void attach(int layer) const;
    [[nodiscard]] XrSwapchainSubImage layer(int layer) const;
    [[nodiscard]] int layers() const { return layers_; }

  private:
    int width_, height_, layers_;
    Owned<XrSwapchain, xrDestroySwapchain> swapchain_;
    std::vector<GLuint> textures_;
    std::uint32_t acquired_ = 0;
};

}  // namespace eti::hmd
