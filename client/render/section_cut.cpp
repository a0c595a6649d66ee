// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/section_cut.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include "client/render/gpu_mesh.hpp"

namespace eti::render {
namespace {

static_assert(sizeof(CutVertex) == 16 && offsetof(CutVertex, colour) == 12);

struct Crossing {
    Vec3f position;
    Vec3f inward;  // unit, in the plane
    VertexColour colour;
};

VertexColour blend(const VertexColour& a, const VertexColour& b, float t) {
    VertexColour mixed{};
    for (std::size_t k = 0; k < mixed.size(); ++k) {
        mixed[k] = static_cast<std::uint8_t>(
            std::lround((1.0f - t) * static_cast<float>(a[k]) + t * static_cast<float>(b[k])));
    }
    return mixed;
}

}  // namespace

std::vector<CutVertex> section_band(std::span<const Triangle> triangles,
                                    std::span<const view::LitVertex> vertices,
                                    std::span<const VertexColour> colours, float x, float width) {
    std::vector<CutVertex> band;
    for (const Triangle& triangle : triangles) {
        std::array<Crossing, 2> ends;
        std::size_t found = 0;
        for (std::size_t corner = 0; corner < 3 && found < 2; ++corner) {
            const std::uint32_t i = triangle[corner], j = triangle[(corner + 1) % 3];
            const view::LitVertex& a = vertices[i];
            const view::LitVertex& b = vertices[j];
            // Half-open, so that a vertex in the plane belongs to one side.
            if ((a.position.x() < x) == (b.position.x() < x)) {
                continue;
            }
            const float t = (x - a.position.x()) / (b.position.x() - a.position.x());
            Vec3f inward = -(a.normal + t * (b.normal - a.normal));
            inward.x() = 0.0f;
            const float length = inward.norm();
            Vec3f position = a.position + t * (b.position - a.position);
            position.x() = x;
            ends[found++] = {position, length > 1e-6f ? Vec3f(inward / length) : Vec3f::Zero(),
                             blend(colours[i], colours[j], t)};
        }
        if (found == 2) {
            const CutVertex a{ends[0].position, ends[0].colour};
            const CutVertex b{ends[1].position, ends[1].colour};
            const CutVertex c{ends[0].position + width * ends[0].inward, ends[0].colour};
            const CutVertex d{ends[1].position + width * ends[1].inward, ends[1].colour};
            band.insert(band.end(), {a, b, c, b, d, c});
        }
    }
    return band;
}

CutMesh::CutMesh() {
    glBindVertexArray(array_.name());
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.name());
    const auto position = static_cast<GLuint>(Attribute::position),
               colour = static_cast<GLuint>(Attribute::colour);
    glEnableVertexAttribArray(position);
    glVertexAttribPointer(position, 3, GL_FLOAT, GL_FALSE, sizeof(CutVertex), nullptr);
    glEnableVertexAttribArray(colour);
    glVertexAttribPointer(colour, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(CutVertex),
                          reinterpret_cast<const void*>(offsetof(CutVertex, colour)));
    glBindVertexArray(0);
}

void CutMesh::draw(std::span<const CutVertex> vertices) const {
    if (vertices.empty()) {
        return;
    }
    glBindVertexArray(array_.name());
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.name());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size_bytes()), vertices.data(),
                 GL_STREAM_DRAW);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices.size()));
}

}  // namespace eti::render
