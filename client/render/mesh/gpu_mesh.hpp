// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>

#include "client/render/gl/gl_object.hpp"
#include "client/render/material.hpp"
#include "client/view/skinned_surface.hpp"
#include "client/view/tube_sweep.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti::render {

/// Vertex attribute locations in the shaders.
enum class Attribute : GLuint {
    position = 0,
    normal = 1,
    colour = 2,
    course = 3,
    relief = 4,
    rest = 5,
    film = 6,
    height = 7
};

/// Describes an attribute of the bound vertex array in the bound buffer; offset and stride [bytes].
void attribute(Attribute which, GLint size, GLenum type, GLboolean normalised, GLsizei stride,
               std::size_t offset);

/// A unit vector as GL_INT_2_10_10_10_REV.
[[nodiscard]] std::uint32_t packed_normal(const Vec3f& normal);

/// A tool's triangle mesh on the GPU; the triangles are constant.
class GpuMesh {
  public:
    /// A rigid mesh: the vertices are constant too.
    GpuMesh(std::span<const Triangle> triangles, std::span<const view::LitVertex> vertices,
            std::span<const VertexColour> colours);
    /// The tube: position, normal, distance from the tip and turn instead of a colour.
    explicit GpuMesh(std::span<const Triangle> triangles);

    void upload(std::span<const view::TubeVertex> vertices);
    void draw() const;

    /// Revision of the last upload, maintained by the caller.
    std::uint64_t revision = 0;

  private:
    void set_indices(std::span<const Triangle> triangles);

    VertexArray array_;
    Buffer vertices_;
    Buffer colours_;
    Buffer indices_;
    GLsizei index_count_ = 0;
};

}  // namespace eti::render
