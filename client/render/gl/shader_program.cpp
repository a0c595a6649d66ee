// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/gl/shader_program.hpp"

#include <array>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace eti::render {
namespace {

class Shader {
  public:
    Shader(GLenum stage, std::string_view name, const std::string& source) : shader_(glCreateShader(stage)) {
        const char* text = source.c_str();
        glShaderSource(shader_, 1, &text, nullptr);
        glCompileShader(shader_);
        GLint compiled = 0;
        glGetShaderiv(shader_, GL_COMPILE_STATUS, &compiled);
        if (compiled == 0) {
            std::array<char, 2048> log{};
            glGetShaderInfoLog(shader_, static_cast<GLsizei>(log.size()), nullptr, log.data());
            glDeleteShader(shader_);
            throw std::runtime_error(
                fmt::format("shader '{}' does not compile on this OpenGL driver: {}", name, log.data()));
        }
    }
    ~Shader() { glDeleteShader(shader_); }
    Shader(Shader&& other) noexcept : shader_(std::exchange(other.shader_, 0)) {}
    Shader(const Shader&) = delete;
    Shader& operator=(const Shader&) = delete;
    Shader& operator=(Shader&&) = delete;
    [[nodiscard]] GLuint name() const { return shader_; }

  private:
    GLuint shader_;
};

std::string head_of(const ShaderProgram::Defines& defines) {
    std::string head = "#version 330 core\n";
    for (const std::string& define : defines) {
        head += fmt::format("#define {}\n", define);
    }
    return head;
}

}  // namespace

ShaderProgram::ShaderProgram(std::string_view name, const Defines& defines, std::string_view vertex,
                             std::string_view fragment) {
    build(name, defines, std::array{Stage{GL_VERTEX_SHADER, vertex}, Stage{GL_FRAGMENT_SHADER, fragment}});
}

ShaderProgram::ShaderProgram(std::string_view name, const Defines& defines, std::string_view vertex,
                             std::string_view geometry, std::string_view fragment) {
    build(name, defines,
          std::array{Stage{GL_VERTEX_SHADER, vertex}, Stage{GL_GEOMETRY_SHADER, geometry},
                     Stage{GL_FRAGMENT_SHADER, fragment}});
}

ShaderProgram::ShaderProgram(std::string_view name, const Defines& defines, std::string_view vertex,
                             std::initializer_list<const char*> outputs) {
    glTransformFeedbackVaryings(program_.name(), static_cast<GLsizei>(outputs.size()), outputs.begin(),
                                GL_INTERLEAVED_ATTRIBS);
    build(name, defines, std::array{Stage{GL_VERTEX_SHADER, vertex}});
}

void ShaderProgram::build(std::string_view name, const Defines& defines, std::span<const Stage> stages) {
    const std::string head = head_of(defines);
    std::vector<Shader> shaders;
    shaders.reserve(stages.size());
    for (const Stage& stage : stages) {
        shaders.emplace_back(stage.stage, name, head + std::string(stage.source));
        glAttachShader(program_.name(), shaders.back().name());
    }
    link(name);
    for (const Shader& shader : shaders) {
        glDetachShader(program_.name(), shader.name());
    }
}

void ShaderProgram::link(std::string_view name) {
    glLinkProgram(program_.name());
    GLint linked = 0;
    glGetProgramiv(program_.name(), GL_LINK_STATUS, &linked);
    if (linked == 0) {
        std::array<char, 2048> log{};
        glGetProgramInfoLog(program_.name(), static_cast<GLsizei>(log.size()), nullptr, log.data());
        throw std::runtime_error(
            fmt::format("shader '{}' does not link on this OpenGL driver: {}", name, log.data()));
    }
}

GLint ShaderProgram::location(std::string_view uniform) {
    const auto known = locations_.find(uniform);
    if (known != locations_.end()) {
        return known->second;
    }
    const std::string text(uniform);
    return locations_[text] = glGetUniformLocation(program_.name(), text.c_str());
}

void ShaderProgram::set(std::string_view uniform, int value) {
    glUniform1i(location(uniform), value);
}
void ShaderProgram::set(std::string_view uniform, float value) {
    glUniform1f(location(uniform), value);
}
void ShaderProgram::set(std::string_view uniform, const Eigen::Vector2f& value) {
    glUniform2fv(location(uniform), 1, value.data());
}
void ShaderProgram::set(std::string_view uniform, const Vec3f& value) {
    glUniform3fv(location(uniform), 1, value.data());
}
void ShaderProgram::set(std::string_view uniform, const Eigen::Vector4f& value) {
    glUniform4fv(location(uniform), 1, value.data());
}
void ShaderProgram::set(std::string_view uniform, const Eigen::Matrix4f& value) {
    glUniformMatrix4fv(location(uniform), 1, GL_FALSE, value.data());
}

void capture(const Buffer& into, std::size_t count) {
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, into.name());
    glEnable(GL_RASTERIZER_DISCARD);
    glBeginTransformFeedback(GL_POINTS);
    glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(count));
    glEndTransformFeedback();
    glDisable(GL_RASTERIZER_DISCARD);
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
}

}  // namespace eti::render
