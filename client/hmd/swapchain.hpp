// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <epoxy/gl.h>

#include <cstdint>
#include <vector>

#include "client/hmd/xr.hpp"

namespace eti::hmd {

/// An sRGB swapchain of one or several layers.
class Swapchain {
  public:
    /// Throws OpenXrError: XR_ERROR_FEATURE_UNSUPPORTED if the runtime has no layered swapchains.
    Swapchain(XrSession session, int width, int height, int layers);

    /// Waits for an image to draw into. Throws OpenXrError.
    void acquire();
    /// Hands the image to the runtime for the next frame.
    void release();
    /// Attaches a layer of the acquired image to the framebuffer bound for drawing.
    void attach(int layer) const;
    [[nodiscard]] XrSwapchainSubImage layer(int layer) const;
    [[nodiscard]] int layers() const { return layers_; }

  private:
    int width_, height_, layers_;
    UniqueHandle<XrSwapchain, xrDestroySwapchain> swapchain_;
    std::vector<GLuint> textures_;
    std::uint32_t acquired_ = 0;
};

}  // namespace eti::hmd
