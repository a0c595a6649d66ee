// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/finer_drawing.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace eti::render {
namespace {

constexpr GLuint place = 0, triangle = 1, steps = 2;
constexpr int first_unit = 5;  // after those of frames, liquid and shadows

const void* offset(std::size_t bytes) {
    return reinterpret_cast<const void*>(bytes);
}

}  // namespace

FinerDrawing::FinerDrawing() {
    std::vector<std::array<std::int8_t, 2>> places;
    std::vector<std::uint16_t> indices;
    for (int n = 2; n <= most_steps; ++n) {
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
    glBindBuffer(GL_ARRAY_BUFFER, places_.name());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(places.size() * sizeof(places[0])), places.data(),
                 GL_STATIC_DRAW);
    glEnableVertexAttribArray(place);
    glVertexAttribIPointer(place, 2, GL_BYTE, sizeof(places[0]), nullptr);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.name());
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(indices[0])),
                 indices.data(), GL_STATIC_DRAW);
    for (const GLuint instanced : {triangle, steps}) {
        glEnableVertexAttribArray(instanced);
        glVertexAttribDivisor(instanced, 1);
    }
    glBindVertexArray(0);
}

void FinerDrawing::apply(const PatientMesh& patient, ShaderProgram& program) const {
    struct Source {
        const char* name;
        GLuint buffer;
        GLenum format;
    };
    const std::array sources{Source{"triangles", patient.indices().name(), GL_R32UI},
                             Source{"skinned", patient.skinned().name(), GL_R32F},
                             Source{"rests", patient.rest().name(), GL_R32F},
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
    program.set("most_bend", most_bend);
}

void FinerDrawing::draw(std::vector<FinerInstance>& faces, ShaderProgram& program) const {
    if (faces.empty()) {
        return;
    }
    // Those of one grid together, else in their order: nearest first.
    std::stable_sort(faces.begin(), faces.end(), [](const FinerInstance& a, const FinerInstance& b) {
        return a.grid() != b.grid() ? a.grid() < b.grid() : a.turned < b.turned;
    });
    glBindVertexArray(array_.name());
    glBindBuffer(GL_ARRAY_BUFFER, faces_.name());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(faces.size() * sizeof(FinerInstance)), faces.data(),
                 GL_STREAM_DRAW);
    for (std::size_t first = 0; first < faces.size();) {
        const int n = faces[first].grid();
        const std::uint8_t turned = faces[first].turned;
        std::size_t end = first;
        while (end < faces.size() && faces[end].grid() == n && faces[end].turned == turned) {
            ++end;
        }
        const Grid& grid = grids_[static_cast<std::size_t>(n)];
        program.set("grid", n);
        glVertexAttribIPointer(triangle, 1, GL_UNSIGNED_INT, sizeof(FinerInstance),
                               offset(first * sizeof(FinerInstance) + offsetof(FinerInstance, triangle)));
        glVertexAttribIPointer(steps, 3, GL_UNSIGNED_BYTE, sizeof(FinerInstance),
                               offset(first * sizeof(FinerInstance) + offsetof(FinerInstance, steps)));
        glDrawElementsInstancedBaseVertex(GL_TRIANGLES, grid.index_count, GL_UNSIGNED_SHORT,
                                          offset(grid.first_index[turned] * sizeof(std::uint16_t)),
                                          static_cast<GLsizei>(end - first), grid.first_place);
        first = end;
    }
    glBindVertexArray(0);
    faces.clear();
}

}  // namespace eti::render
