// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/gl/render_target.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

namespace eti::render {
namespace {

void attach_renderbuffer(GLuint framebuffer, GLenum point, GLuint renderbuffer) {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, point, GL_RENDERBUFFER, renderbuffer);
}

void allocate_storage(GLuint renderbuffer, GLenum format, int width, int height, int samples) {
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
        throw std::runtime_error(fmt::format(
            "the OpenGL driver cannot create a {} x {} framebuffer (status {:#x}). Choose a smaller --size.",
            width, height, state));
    }
}

}  // namespace

RenderTarget::RenderTarget(int width, int height, int samples) : width_(width), height_(height) {
    GLint most = 1;
    glGetIntegerv(GL_MAX_SAMPLES, &most);
    const int used = std::clamp(samples, 1, std::max(1, static_cast<int>(most)));
    allocate_storage(picture_colour_.name(), GL_SRGB8_ALPHA8, width, height, 1);
    attach_renderbuffer(picture_.name(), GL_COLOR_ATTACHMENT0, picture_colour_.name());
    require_complete(picture_.name(), width, height);
    allocate_hdr_target(light_, scene_, width, height);
    allocate_storage(depth_stencil_.name(), GL_DEPTH24_STENCIL8, width, height, used);
    if (used > 1) {
        sampled_.emplace();
        allocate_storage(sampled_->light.name(), GL_RGBA16F, width, height, used);
        attach_renderbuffer(sampled_->framebuffer.name(), GL_COLOR_ATTACHMENT0, sampled_->light.name());
        attach_renderbuffer(sampled_->framebuffer.name(), GL_DEPTH_STENCIL_ATTACHMENT, depth_stencil_.name());
        require_complete(sampled_->framebuffer.name(), width, height);
    } else {
        attach_renderbuffer(scene_.name(), GL_DEPTH_STENCIL_ATTACHMENT, depth_stencil_.name());
        attach_renderbuffer(picture_.name(), GL_DEPTH_STENCIL_ATTACHMENT, depth_stencil_.name());
        require_complete(picture_.name(), width, height);
    }
    require_complete(scene_.name(), width, height);
}

void RenderTarget::bind_scene() const {
    glBindFramebuffer(GL_FRAMEBUFFER, sampled_ ? sampled_->framebuffer.name() : scene_.name());
}

void RenderTarget::resolve(const Viewport& area) const {
    if (sampled_) {
        const int right = area.x + area.width, top = area.y + area.height;
        glBindFramebuffer(GL_READ_FRAMEBUFFER, sampled_->framebuffer.name());
        glBindFramebuffer(GL_DRAW_FRAMEBUFFER, scene_.name());
        glBlitFramebuffer(area.x, area.y, right, top, area.x, area.y, right, top, GL_COLOR_BUFFER_BIT,
                          GL_NEAREST);
    }
}

void RenderTarget::bind_picture() const {
    glBindFramebuffer(GL_FRAMEBUFFER, picture_.name());
    glViewport(0, 0, width_, height_);
}

Image RenderTarget::read() const {
    Image image{width_, height_, {}};
    const std::size_t row = 4 * static_cast<std::size_t>(width_);
    image.rgba.resize(row * static_cast<std::size_t>(height_));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, picture_.name());
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

void RenderTarget::copy_to(GLuint framebuffer, const Viewport& from, const Viewport& to) const {
    const bool scaled = from.width != to.width || from.height != to.height;
    glBindFramebuffer(GL_READ_FRAMEBUFFER, picture_.name());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
    glBlitFramebuffer(from.x, from.y, from.x + from.width, from.y + from.height, to.x, to.y, to.x + to.width,
                      to.y + to.height, GL_COLOR_BUFFER_BIT, scaled ? GL_LINEAR : GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

void allocate_hdr_target(const Texture& texture, const Framebuffer& framebuffer, int width, int height) {
    glBindTexture(GL_TEXTURE_2D, texture.name());
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16F, width, height, 0, GL_RGBA, GL_HALF_FLOAT, nullptr);
    set_filter(GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture.name(), 0);
}

}  // namespace eti::render
