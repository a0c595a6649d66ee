// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <epoxy/gl.h>

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
struct Buffer {
    static GLuint create() {
        GLuint name = 0;
        glGenBuffers(1, &name);
        return name;
    }
    static void destroy(GLuint name) { glDeleteBuffers(1, &name); }
};
struct VertexArray {
    static GLuint create() {
        GLuint name = 0;
        glGenVertexArrays(1, &name);
        return name;
    }
    static void destroy(GLuint name) { glDeleteVertexArrays(1, &name); }
};
struct Texture {
    static GLuint create() {
        GLuint name = 0;
        glGenTextures(1, &name);
        return name;
    }
    static void destroy(GLuint name) { glDeleteTextures(1, &name); }
};
struct Renderbuffer {
    static GLuint create() {
        GLuint name = 0;
        glGenRenderbuffers(1, &name);
        return name;
    }
    static void destroy(GLuint name) { glDeleteRenderbuffers(1, &name); }
};
struct Framebuffer {
    static GLuint create() {
        GLuint name = 0;
        glGenFramebuffers(1, &name);
        return name;
    }
    static void destroy(GLuint name) { glDeleteFramebuffers(1, &name); }
};
struct Program {
    static GLuint create() { return glCreateProgram(); }
    static void destroy(GLuint name) { glDeleteProgram(name); }
};
}  // namespace kind

using Buffer = GlObject<kind::Buffer>;
using VertexArray = GlObject<kind::VertexArray>;
using Texture = GlObject<kind::Texture>;
using Renderbuffer = GlObject<kind::Renderbuffer>;
using Framebuffer = GlObject<kind::Framebuffer>;
using Program = GlObject<kind::Program>;

/// An offset in the bound buffer [bytes], as the pointer that OpenGL expects.
inline const void* buffer_offset(std::size_t bytes) {
    return reinterpret_cast<const void*>(bytes);
}

}  // namespace eti::render
