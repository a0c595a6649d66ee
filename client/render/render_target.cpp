// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/render_target.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

namespace eti::render {
namespace {

void attach(GLuint framebuffer, GLenum point, GLuint renderbuffer) {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, point, GL_RENDERBUFFER, renderbuffer);
}

void store(GLuint renderbuffer, GLenum format, int width, int height, int samples) {
    glBindRenderbuffer(GL_RENDERBUFFER, renderbuffer);
    if (samples > 1) {
        glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
    } else {
        glRenderbufferStorage(GL_RENDERBUFFER, format, width, height);
    }
}

void require_complete(GLuint framebuffer, int width, int height) {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    const GLenum state = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    if (state != GL_FRAMEBUFFER_COMPLETE) {
        throw std::runtime_error(
            fmt::format("the OpenGL driver gives no {} x {} picture (state {:#x}). Choose a smaller --size.",
                        width, height, state));
    }
}

}  // namespace

RenderTarget::RenderTarget(int width, int height, int samples) : width_(width), height_(height) {
    GLint most = 1;
    glGetIntegerv(GL_MAX_SAMPLES, &most);
    const int used = std::clamp(samples, 1, std::max(1, static_cast<int>(most)));
    store(plain_colour_.name(), GL_SRGB8_ALPHA8, width, height, 1);
    attach(plain_.name(), GL_COLOR_ATTACHMENT0, plain_colour_.name());
    store(depth_stencil_.name(), GL_DEPTH24_STENCIL8, width, height, used);
    if (used > 1) {
        sampled_.emplace();
        sampled_colour_.emplace();
        store(sampled_colour_->name(), GL_SRGB8_ALPHA8, width, height, used);
        attach(sampled_->name(), GL_COLOR_ATTACHMENT0, sampled_colour_->name());
        attach(sampled_->name(), GL_DEPTH_STENCIL_ATTACHMENT, depth_stencil_.name());
        require_complete(sampled_->name(), width, height);
    } else {
        attach(plain_.name(), GL_DEPTH_STENCIL_ATTACHMENT, depth_stencil_.name());
    }
    require_complete(plain_.name(), width, height);
}

void RenderTarget::bind_scene() const {
    glBindFramebuffer(GL_FRAMEBUFFER, sampled_ ? sampled_->name() : plain_.name());
    glViewport(0, 0, width_, height_);
}

void RenderTarget::resolve() const {
    if (sampled_) {
        glBindFramebuffer(GL_READ_FRAMEBUFFER, sampled_->name());
        glBindFramebuffer(GL_DRAW_FRAMEBUFFER, plain_.name());
        glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, plain_.name());
    glViewport(0, 0, width_, height_);
}

Image RenderTarget::read() const {
    Image image{width_, height_, {}};
    const std::size_t row = 4 * static_cast<std::size_t>(width_);
    image.rgba.resize(row * static_cast<std::size_t>(height_));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, plain_.name());
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
    // OpenGL's first row is the bottom one.
    for (int low = 0, high = height_ - 1; low < high; ++low, --high) {
        auto* const begin = image.rgba.data();
        std::swap_ranges(begin + row * static_cast<std::size_t>(low),
                         begin + row * static_cast<std::size_t>(low + 1),
                         begin + row * static_cast<std::size_t>(high));
    }
    return image;
}

void RenderTarget::copy_to_window() const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, plain_.name());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

}  // namespace eti::render
