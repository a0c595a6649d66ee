// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hmd/swapchain.hpp"

#include <algorithm>

#include "client/hmd/platform.hpp"

namespace eti::hmd {
namespace {

// The pictures are already sRGB-encoded; a linear format would show them too bright.
constexpr std::int64_t format = GL_SRGB8_ALPHA8;

void require_format(XrSession session) {
    std::uint32_t count = 0;
    check(xrEnumerateSwapchainFormats(session, 0, &count, nullptr), "xrEnumerateSwapchainFormats");
    std::vector<std::int64_t> offered(count);
    check(xrEnumerateSwapchainFormats(session, count, &count, offered.data()), "xrEnumerateSwapchainFormats");
    if (std::ranges::find(offered, format) == offered.end()) {
        throw OpenXrError("the GL_SRGB8_ALPHA8 image format", XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED);
    }
}

}  // namespace

Swapchain::Swapchain(XrSession session, int width, int height, int layers)
    : width_(width), height_(height), layers_(layers) {
    require_format(session);
    auto info = make_struct<XrSwapchainCreateInfo>(XR_TYPE_SWAPCHAIN_CREATE_INFO);
    info.usageFlags = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT;
    info.format = format;
    info.sampleCount = 1;
    info.width = static_cast<std::uint32_t>(width);
    info.height = static_cast<std::uint32_t>(height);
    info.faceCount = 1;
    info.arraySize = static_cast<std::uint32_t>(layers);
    info.mipCount = 1;
    check(xrCreateSwapchain(session, &info, swapchain_.put()), "xrCreateSwapchain");
    std::uint32_t count = 0;
    check(xrEnumerateSwapchainImages(swapchain_.get(), 0, &count, nullptr), "xrEnumerateSwapchainImages");
    std::vector<XrSwapchainImageOpenGLKHR> images(
        count, make_struct<XrSwapchainImageOpenGLKHR>(XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR));
    check(xrEnumerateSwapchainImages(swapchain_.get(), count, &count,
                                     reinterpret_cast<XrSwapchainImageBaseHeader*>(images.data())),
          "xrEnumerateSwapchainImages");
    for (const XrSwapchainImageOpenGLKHR& image : images) {
        textures_.push_back(image.image);
    }
}

void Swapchain::acquire() {
    check(xrAcquireSwapchainImage(swapchain_.get(), nullptr, &acquired_), "xrAcquireSwapchainImage");
    auto wait = make_struct<XrSwapchainImageWaitInfo>(XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO);
    wait.timeout = XR_INFINITE_DURATION;
    check(xrWaitSwapchainImage(swapchain_.get(), &wait), "xrWaitSwapchainImage");
}

void Swapchain::release() {
    check(xrReleaseSwapchainImage(swapchain_.get(), nullptr), "xrReleaseSwapchainImage");
}

void Swapchain::attach(int layer) const {
    const GLuint texture = textures_[acquired_];
    if (layers_ > 1) {
        glFramebufferTextureLayer(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, texture, 0, layer);
    } else {
        glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    }
}

XrSwapchainSubImage Swapchain::layer(int layer) const {
    return {swapchain_.get(), {{0, 0}, {width_, height_}}, static_cast<std::uint32_t>(layer)};
}

}  // namespace eti::hmd
