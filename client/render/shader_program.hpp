// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include <initializer_list>
#include <map>
#include <string>
#include <string_view>

#include "client/render/gl_object.hpp"
#include "common/math/transform.hpp"

namespace eti::render {

/// A linked vertex and fragment shader. Setting a uniform that the compiler found unused is no error.
class ShaderProgram {
  public:
    /// `defines` are put before both sources. Throws std::runtime_error with the driver's log.
    ShaderProgram(std::string_view name, std::initializer_list<std::string_view> defines,
                  std::string_view vertex, std::string_view fragment);

    void use() const { glUseProgram(program_.name()); }

    // The program must be in use.
    void set(std::string_view uniform, int value);
    void set(std::string_view uniform, float value);
    void set(std::string_view uniform, const Eigen::Vector2f& value);
    void set(std::string_view uniform, const Vec3f& value);
    void set(std::string_view uniform, const Eigen::Vector4f& value);
    void set(std::string_view uniform, const Eigen::Matrix4f& value);

  private:
    GLint location(std::string_view uniform);

    Program program_;
    std::map<std::string, GLint, std::less<>> locations_;
};

}  // namespace eti::render
