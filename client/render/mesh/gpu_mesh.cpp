// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/mesh/gpu_mesh.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

namespace eti::render {
namespace {

static_assert(sizeof(view::LitVertex) == 24 && offsetof(view::LitVertex, normal) == 12);
static_assert(sizeof(Triangle) == 12 && sizeof(VertexColour) == 4);

// The tube is uploaded with each state: 20 bytes per vertex instead of 32.
struct PackedTubeVertex {
    Vec3f position;
    std::uint32_t normal;  // ten bits per component
    Eigen::half from_tip, around;
};
static_assert(sizeof(PackedTubeVertex) == 20 && offsetof(PackedTubeVertex, from_tip) == 16);

}  // namespace

std::uint32_t packed_normal(const Vec3f& normal) {
    std::uint32_t packed = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const auto value = static_cast<std::int32_t>(std::lround(511.0f * normal[axis]));
        packed |= (static_cast<std::uint32_t>(value) & 0x3ffu) << (10 * axis);
    }
    return packed;
}

void attribute(Attribute which, GLint size, GLenum type, GLboolean normalised, GLsizei stride,
               std::size_t offset) {
    glEnableVertexAttribArray(static_cast<GLuint>(which));
    glVertexAttribPointer(static_cast<GLuint>(which), size, type, normalised, stride, buffer_offset(offset));
}

GpuMesh::GpuMesh(std::span<const Triangle> triangles, std::span<const view::LitVertex> vertices,
                 std::span<const VertexColour> colours) {
    glBindVertexArray(array_.name());
    render::upload(GL_ARRAY_BUFFER, vertices_, vertices, GL_STATIC_DRAW);
    attribute(Attribute::position, 3, GL_FLOAT, GL_FALSE, 24, 0);
    attribute(Attribute::normal, 3, GL_FLOAT, GL_FALSE, 24, 12);
    render::upload(GL_ARRAY_BUFFER, colours_, colours, GL_STATIC_DRAW);
    attribute(Attribute::colour, 4, GL_UNSIGNED_BYTE, GL_TRUE, 4, 0);
    set_indices(triangles);
}

GpuMesh::GpuMesh(std::span<const Triangle> triangles) {
    glBindVertexArray(array_.name());
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.name());
    attribute(Attribute::position, 3, GL_FLOAT, GL_FALSE, sizeof(PackedTubeVertex), 0);
    attribute(Attribute::normal, 4, GL_INT_2_10_10_10_REV, GL_TRUE, sizeof(PackedTubeVertex), 12);
    attribute(Attribute::course, 2, GL_HALF_FLOAT, GL_FALSE, sizeof(PackedTubeVertex), 16);
    set_indices(triangles);
}

void GpuMesh::set_indices(std::span<const Triangle> triangles) {
    index_count_ = static_cast<GLsizei>(3 * triangles.size());
    render::upload(GL_ELEMENT_ARRAY_BUFFER, indices_, triangles, GL_STATIC_DRAW);
    glBindVertexArray(0);
}

void GpuMesh::upload(std::span<const view::TubeVertex> vertices) {
    std::vector<PackedTubeVertex> packed;
    packed.reserve(vertices.size());
    for (const view::TubeVertex& vertex : vertices) {
        packed.push_back({vertex.position, packed_normal(vertex.normal), Eigen::half(vertex.from_tip),
                          Eigen::half(vertex.around)});
    }
    render::upload(GL_ARRAY_BUFFER, vertices_, packed, GL_STREAM_DRAW);
}

void GpuMesh::draw() const {
    glBindVertexArray(array_.name());
    glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace eti::render
