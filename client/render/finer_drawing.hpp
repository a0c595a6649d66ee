// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "client/render/finer_faces.hpp"
#include "client/render/gl_object.hpp"
#include "client/render/patient_mesh.hpp"
#include "client/render/shader_program.hpp"

namespace eti::render {

/// Draws triangles of a patient as grids, one instance a triangle, by programs that are made with FINER: of a
/// picture only the triangles' numbers are sent.
class FinerDrawing {
  public:
    FinerDrawing();

    /// Whether a patient is not too large for that.
    [[nodiscard]] bool takes(const PatientMesh& patient) const;
    /// Sets what such a program needs; it must be in use.
    void apply(const PatientMesh& patient, ShaderProgram& program) const;
    /// Empties `faces`.
    void draw(std::vector<FinerInstance>& faces, ShaderProgram& program);

  private:
    struct Grid {
        GLint first_place = 0;
        std::array<std::size_t, 2> first_index{};  // by FinerFace::turned
        GLsizei index_count = 0;
    };

    VertexArray array_;
    Buffer places_, indices_, faces_;
    std::array<Grid, most_steps + 1> grids_{};
    std::array<Texture, 6> textures_;
    GLint most_texels_ = 0;
    std::vector<std::uint32_t> packed_;
};

}  // namespace eti::render
