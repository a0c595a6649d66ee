// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hmd/eye_images.hpp"

namespace eti::hmd {
namespace {

void acquire(Swapchain& chain, const Graphics& graphics) {
    chain.acquire();
    graphics.make_current();
}

void copy(const render::RenderTarget& from, const render::Viewport& area, const Swapchain& chain, int layer,
          const render::Framebuffer& framebuffer) {
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer.name());
    chain.attach(layer);
    from.copy_to(framebuffer.name(), area, {0, 0, area.width, area.height});
}

}  // namespace

EyeImages::EyeImages(XrSession session, const Graphics& graphics, int eye_width, int eye_height)
    : graphics_(graphics), width_(eye_width), height_(eye_height) {
    try {
        chains_.push_back(std::make_unique<Swapchain>(session, eye_width, eye_height, 2));
    } catch (const OpenXrError& failed) {
        if (failed.result != XR_ERROR_FEATURE_UNSUPPORTED) {
            throw;
        }
        for (int eye = 0; eye < 2; ++eye) {
            chains_.push_back(std::make_unique<Swapchain>(session, eye_width, eye_height, 1));
        }
    }
    graphics_.make_current();
}

void EyeImages::show(const render::RenderTarget& both) {
    for (const auto& chain : chains_) {
        acquire(*chain, graphics_);
    }
    for (int eye = 0; eye < 2; ++eye) {
        const Swapchain& chain = layered() ? *chains_.front() : *chains_[static_cast<std::size_t>(eye)];
        copy(both, {eye * width_, 0, width_, height_}, chain, layered() ? eye : 0, framebuffer_);
    }
    for (const auto& chain : chains_) {
        chain->release();
    }
}

XrSwapchainSubImage EyeImages::of(int eye) const {
    return layered() ? chains_.front()->layer(eye) : chains_[static_cast<std::size_t>(eye)]->layer(0);
}

QuadImage::QuadImage(XrSession session, const Graphics& graphics, int width, int height)
    : graphics_(graphics), chain_(session, width, height, 1) {
    graphics_.make_current();
}

void QuadImage::show(const render::RenderTarget& panel) {
    acquire(chain_, graphics_);
    copy(panel, {0, 0, panel.width(), panel.height()}, chain_, 0, framebuffer_);
    chain_.release();
}

}  // namespace eti::hmd
