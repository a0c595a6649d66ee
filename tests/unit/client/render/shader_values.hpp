// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "client/render/gl/gl_object.hpp"
#include "client/render/gl/render_target.hpp"
#include "client/render/gl/shader_program.hpp"

namespace eti::test {

/// Evaluates a vertex shader that writes `result` on points.
inline std::vector<Eigen::Vector4f> computed(render::ShaderProgram& program,
                                             const std::vector<Vec3f>& points) {
    const render::RenderTarget target(8, 8, 1);
    target.bind_scene();
    const render::VertexArray array;
    const render::Buffer in, out;
    glBindVertexArray(array.name());
    glBindBuffer(GL_ARRAY_BUFFER, in.name());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(points.size() * sizeof(Vec3f)), points.data(),
                 GL_STATIC_DRAW);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vec3f), nullptr);
    glBindBuffer(GL_ARRAY_BUFFER, out.name());
    std::vector<Eigen::Vector4f> result(points.size());
    const auto size = static_cast<GLsizeiptr>(result.size() * sizeof(Eigen::Vector4f));
    glBufferData(GL_ARRAY_BUFFER, size, nullptr, GL_DYNAMIC_READ);
    program.use();
    render::capture(out, points.size());
    glGetBufferSubData(GL_ARRAY_BUFFER, 0, size, result.data());
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    return result;
}

}  // namespace eti::test
