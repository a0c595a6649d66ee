// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include <initializer_list>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/render/gl/gl_object.hpp"
#include "common/math/transform.hpp"

namespace eti::render {

/// A linked shader program. Setting a uniform that the compiler removed as unused is not an error.
class ShaderProgram {
  public:
    /// Prepended to all sources, as "NAME" or "NAME value".
    using Defines = std::vector<std::string>;

    /// Throws std::runtime_error with the driver's log.
    ShaderProgram(std::string_view name, const Defines& defines, std::string_view vertex,
                  std::string_view fragment);
    /// With a geometry shader.
    ShaderProgram(std::string_view name, const Defines& defines, std::string_view vertex,
                  std::string_view geometry, std::string_view fragment);
    /// A transform feedback program: writes the vertex shader's `outputs` interleaved into a buffer and
    /// rasterises nothing.
    ShaderProgram(std::string_view name, const Defines& defines, std::string_view vertex,
                  std::initializer_list<const char*> outputs);

    void use() const { glUseProgram(program_.name()); }

    // The program must be in use.
    void set(std::string_view uniform, int value);
    void set(std::string_view uniform, float value);
    void set(std::string_view uniform, const Eigen::Vector2f& value);
    void set(std::string_view uniform, const Vec3f& value);
    void set(std::string_view uniform, const Eigen::Vector4f& value);
    void set(std::string_view uniform, const Eigen::Matrix4f& value);

  private:
    struct Stage {
        GLenum stage;
        std::string_view source;
    };
    void build(std::string_view name, const Defines& defines, std::span<const Stage> stages);
    void link(std::string_view name);
    GLint location(std::string_view uniform);

    Program program_;
    std::map<std::string, GLint, std::less<>> locations_;
};

/// Runs the program in use on the first `count` vertices of the bound array and captures the outputs in a
/// buffer; rasterises nothing.
void capture(const Buffer& into, std::size_t count);

}  // namespace eti::render
