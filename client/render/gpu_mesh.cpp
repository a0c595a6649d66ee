// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/gpu_mesh.hpp"

#include <cstddef>

namespace eti::render {
namespace {

static_assert(sizeof(view::LitVertex) == 24 && offsetof(view::LitVertex, normal) == 12);
static_assert(sizeof(view::TubeVertex) == 32 && offsetof(view::TubeVertex, from_tip) == 24);
static_assert(sizeof(Triangle) == 12 && sizeof(VertexColour) == 4);

void attribute(Attribute which, GLint size, GLenum type, GLboolean normalised, GLsizei stride,
               std::size_t offset) {
    glEnableVertexAttribArray(static_cast<GLuint>(which));
    glVertexAttribPointer(static_cast<GLuint>(which), size, type, normalised, stride,
                          reinterpret_cast<const void*>(offset));
}

}  // namespace

GpuMesh::GpuMesh(std::span<const Triangle> triangles, std::span<const VertexColour> colours) {
    glBindVertexArray(array_.name());
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.name());
    attribute(Attribute::position, 3, GL_FLOAT, GL_FALSE, 24, 0);
    attribute(Attribute::normal, 3, GL_FLOAT, GL_FALSE, 24, 12);
    glBindBuffer(GL_ARRAY_BUFFER, colours_.name());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(colours.size_bytes()), colours.data(),
                 GL_STATIC_DRAW);
    attribute(Attribute::colour, 4, GL_UNSIGNED_BYTE, GL_TRUE, 4, 0);
    set_indices(triangles);
}

GpuMesh::GpuMesh(std::span<const Triangle> triangles) {
    glBindVertexArray(array_.name());
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.name());
    attribute(Attribute::position, 3, GL_FLOAT, GL_FALSE, 32, 0);
    attribute(Attribute::normal, 3, GL_FLOAT, GL_FALSE, 32, 12);
    attribute(Attribute::course, 2, GL_FLOAT, GL_FALSE, 32, 24);
    set_indices(triangles);
}

void GpuMesh::set_indices(std::span<const Triangle> triangles) {
    index_count_ = static_cast<GLsizei>(3 * triangles.size());
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.name());
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.size_bytes()), triangles.data(),
                 GL_STATIC_DRAW);
    glBindVertexArray(0);
}

void GpuMesh::upload_bytes(const void* data, std::size_t bytes) {
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.name());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes), data, GL_STREAM_DRAW);
}

void GpuMesh::upload(std::span<const view::LitVertex> vertices) {
    upload_bytes(vertices.data(), vertices.size_bytes());
}

void GpuMesh::upload(std::span<const view::TubeVertex> vertices) {
    upload_bytes(vertices.data(), vertices.size_bytes());
}

void GpuMesh::draw(std::span<const Triangle> triangles) const {
    glBindVertexArray(array_.name());
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, chosen_.name());
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.size_bytes()), triangles.data(),
                 GL_STREAM_DRAW);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * triangles.size()), GL_UNSIGNED_INT, nullptr);
}

void GpuMesh::draw() const {
    glBindVertexArray(array_.name());
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.name());
    glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace eti::render
