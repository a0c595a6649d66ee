// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/passes/tessellation_renderer.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>

namespace eti::render {
namespace {

constexpr GLuint place_attribute = 0, face_attribute = 1;
constexpr int first_unit = 5;  // after the units of frames, liquid and shadows

}  // namespace

TessellationRenderer::TessellationRenderer() {
    std::vector<std::array<std::int8_t, 2>> places;
    std::vector<std::uint16_t> indices;
    for (int code = 1; code < step_codes; ++code) {
        const int n = steps_of(code);
        Grid& grid = grids_[static_cast<std::size_t>(n)];
        grid.first_place = static_cast<GLint>(places.size());
        for (int j = 0; j <= n; ++j) {
            for (int i = 0; i <= n - j; ++i) {
                places.push_back({static_cast<std::int8_t>(i), static_cast<std::int8_t>(j)});
            }
        }
        for (const bool turned : {false, true}) {
            grid.first_index[turned ? 1 : 0] = indices.size();
            for (const Triangle& t : grid_triangles(n, turned)) {
                for (const std::uint32_t v : t) {
                    indices.push_back(static_cast<std::uint16_t>(v));
                }
            }
        }
        grid.index_count = 3 * n * n;
    }
    glBindVertexArray(array_.name());
    upload(GL_ARRAY_BUFFER, places_, places, GL_STATIC_DRAW);
    glEnableVertexAttribArray(place_attribute);
    glVertexAttribIPointer(place_attribute, 2, GL_BYTE, sizeof(places[0]), nullptr);
    upload(GL_ELEMENT_ARRAY_BUFFER, indices_, indices, GL_STATIC_DRAW);
    glEnableVertexAttribArray(face_attribute);
    glVertexAttribDivisor(face_attribute, 1);
    glBindVertexArray(0);
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most_texels_);
}

bool TessellationRenderer::takes(const PatientMesh& patient) const {
    // Vertices and triangles take three texels each.
    const auto most = static_cast<std::size_t>(most_texels_);
    return patient.triangle_count() <= std::min(max_triangles, most / 3) &&
           patient.vertex_count() <= most / 3;
}

void TessellationRenderer::apply(const PatientMesh& patient, ShaderProgram& program) const {
    struct Source {
        const char* name;
        GLuint buffer;
        GLenum format;
    };
    const std::array sources{Source{"triangles", patient.indices().name(), GL_R32UI},
                             Source{"skinned", patient.skinned().name(), GL_RG32F},
                             Source{"rests", patient.rest().name(), GL_RG32F},
                             Source{"colours", patient.colours().name(), GL_RGBA8},
                             Source{"reliefs", patient.relief().name(), GL_RGBA8},
                             Source{"films", patient.film(), GL_R32F}};
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const int unit = first_unit + static_cast<int>(i);
        program.set(sources[i].name, unit);
        glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
        glBindTexture(GL_TEXTURE_BUFFER, textures_[i].name());
        if (sources[i].buffer != 0) {
            glTexBuffer(GL_TEXTURE_BUFFER, sources[i].format, sources[i].buffer);
        }
    }
    program.set("max_bend", max_bend);
}

void TessellationRenderer::draw(std::vector<TessellatedInstance>& faces, ShaderProgram& program) {
    if (faces.empty()) {
        return;
    }
    // Sorted by grid, otherwise in their order: nearest first.
    std::stable_sort(faces.begin(), faces.end(),
                     [](const TessellatedInstance& a, const TessellatedInstance& b) {
                         return a.grid() != b.grid() ? a.grid() < b.grid() : a.turned < b.turned;
                     });
    packed_.clear();
    std::ranges::transform(faces, std::back_inserter(packed_), pack);
    glBindVertexArray(array_.name());
    upload(GL_ARRAY_BUFFER, faces_, packed_, GL_STREAM_DRAW);
    for (std::size_t first = 0; first < faces.size();) {
        const int n = faces[first].grid();
        const std::uint8_t turned = faces[first].turned;
        std::size_t end = first;
        while (end < faces.size() && faces[end].grid() == n && faces[end].turned == turned) {
            ++end;
        }
        const Grid& grid = grids_[static_cast<std::size_t>(n)];
        program.set("grid", n);
        glVertexAttribIPointer(face_attribute, 1, GL_UNSIGNED_INT, sizeof(packed_[0]),
                               buffer_offset(first * sizeof(packed_[0])));
        glDrawElementsInstancedBaseVertex(GL_TRIANGLES, grid.index_count, GL_UNSIGNED_SHORT,
                                          buffer_offset(grid.first_index[turned] * sizeof(std::uint16_t)),
                                          static_cast<GLsizei>(end - first), grid.first_place);
        first = end;
    }
    glBindVertexArray(0);
    faces.clear();
}

}  // namespace eti::render
