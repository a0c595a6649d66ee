// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "client/render/gl/gl_object.hpp"
#include "client/render/gl/shader_program.hpp"
#include "client/render/mesh/outline_tessellation.hpp"
#include "client/render/mesh/patient_mesh.hpp"

namespace eti::render {

/// Draws triangles of a patient as grids, one instance per triangle, with programs built with FINER; only
/// the triangles' numbers are uploaded per picture.
class TessellationRenderer {
  public:
    TessellationRenderer();

    /// Whether the patient is small enough.
    [[nodiscard]] bool takes(const PatientMesh& patient) const;
    /// Sets the uniforms of such a program, which must be in use.
    void apply(const PatientMesh& patient, ShaderProgram& program) const;
    /// Draws and clears `faces`, in the GL state of the pass that calls it.
    void draw(std::vector<TessellatedInstance>& faces, ShaderProgram& program);

  private:
    struct Grid {
        GLint first_place = 0;
        std::array<std::size_t, 2> first_index{};  // by TessellatedFace::turned
        GLsizei index_count = 0;
    };

    VertexArray array_;
    Buffer places_, indices_, faces_;
    std::array<Grid, max_steps + 1> grids_{};
    std::array<Texture, 6> textures_;
    GLint most_texels_ = 0;
    std::vector<std::uint32_t> packed_;
};

}  // namespace eti::render
