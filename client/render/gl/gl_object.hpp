// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <epoxy/gl.h>

#include <ranges>
#include <utility>

namespace eti::render {

/// Owns one OpenGL name. Must be created and destroyed while its context is current.
template <class Kind>
class GlObject {
  public:
    GlObject() : name_(Kind::create()) {}
    ~GlObject() {
        if (name_ != 0) {
            Kind::destroy(name_);
        }
    }
    GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    GlObject& operator=(GlObject&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    GlObject(const GlObject&) = delete;
    GlObject& operator=(const GlObject&) = delete;

    [[nodiscard]] GLuint name() const { return name_; }

  private:
    GLuint name_;
};

namespace kind {
/// Names from OpenGL's glGen and glDelete functions, which epoxy loads into these variables.
template <PFNGLGENBUFFERSPROC& gen, PFNGLDELETEBUFFERSPROC& del>
struct Generated {
    static GLuint create() {
        GLuint name = 0;
        gen(1, &name);
        return name;
    }
    static void destroy(GLuint name) { del(1, &name); }
};
struct Program {
    static GLuint create() { return glCreateProgram(); }
    static void destroy(GLuint name) { glDeleteProgram(name); }
};
}  // namespace kind

using Buffer = GlObject<kind::Generated<epoxy_glGenBuffers, epoxy_glDeleteBuffers>>;
using VertexArray = GlObject<kind::Generated<epoxy_glGenVertexArrays, epoxy_glDeleteVertexArrays>>;
using Texture = GlObject<kind::Generated<epoxy_glGenTextures, epoxy_glDeleteTextures>>;
using Renderbuffer = GlObject<kind::Generated<epoxy_glGenRenderbuffers, epoxy_glDeleteRenderbuffers>>;
using Framebuffer = GlObject<kind::Generated<epoxy_glGenFramebuffers, epoxy_glDeleteFramebuffers>>;
using Program = GlObject<kind::Program>;

/// An offset in the bound buffer [bytes], as the pointer that OpenGL expects.
inline const void* buffer_offset(std::size_t bytes) {
    return reinterpret_cast<const void*>(bytes);
}

/// Replaces a buffer's content by a contiguous range and leaves the buffer bound to `target`.
template <std::ranges::contiguous_range Values>
void upload(GLenum target, const Buffer& buffer, const Values& values, GLenum usage) {
    const auto* const data = std::ranges::data(values);
    glBindBuffer(target, buffer.name());
    glBufferData(target, static_cast<GLsizeiptr>(std::ranges::size(values) * sizeof(*data)), data, usage);
}

/// Sets how the bound two-dimensional texture is sampled at any scale: GL_NEAREST or GL_LINEAR.
inline void set_filter(GLint filter) {
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
}

}  // namespace eti::render
