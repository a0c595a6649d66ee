// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/support/headset_runtime/runtime_swapchain.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace eti::headset_runtime {

RuntimeSwapchain::RuntimeSwapchain(int wide, int high, int deep, GLenum format)
    : width(wide), height(high), layers(deep) {
    const GLenum target = layers > 1 ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D;
    glGenTextures(length, textures.data());
    for (const GLuint texture : textures) {
        glBindTexture(target, texture);
        if (layers > 1) {
            glTexImage3D(target, 0, static_cast<GLint>(format), width, height, layers, 0, GL_RGBA,
                         GL_UNSIGNED_BYTE, nullptr);
        } else {
            glTexImage2D(target, 0, static_cast<GLint>(format), width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                         nullptr);
        }
        glTexParameteri(target, GL_TEXTURE_MAX_LEVEL, 0);
    }
    glBindTexture(target, 0);
}

RuntimeSwapchain::~RuntimeSwapchain() {
    glDeleteTextures(length, textures.data());
}

void RuntimeSwapchain::write(int layer, const std::filesystem::path& file) const {
    GLint before = 0;
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &before);
    GLuint framebuffer = 0;
    glGenFramebuffers(1, &framebuffer);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    const GLuint texture = textures[(next + length - 1) % length];
    if (layers > 1) {
        glFramebufferTextureLayer(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, texture, 0, layer);
    } else {
        glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    }
    cv::Mat upside_down(height, width, CV_8UC4), image;
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, width, height, GL_BGRA, GL_UNSIGNED_BYTE, upside_down.data);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(before));
    glDeleteFramebuffers(1, &framebuffer);
    image.create(height, width, CV_8UC4);
    for (int y = 0; y < height; ++y) {
        upside_down.row(height - 1 - y).copyTo(image.row(y));
    }
    cv::imwrite(file.string(), image);
}

}  // namespace eti::headset_runtime
