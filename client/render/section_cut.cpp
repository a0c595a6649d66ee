// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/section_cut.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "client/render/gpu_mesh.hpp"

namespace eti::render {
namespace {

static_assert(sizeof(CutVertex) == 16 && offsetof(CutVertex, colour) == 12);

VertexColour blend(const VertexColour& a, const VertexColour& b, float t) {
    VertexColour mixed{};
    for (std::size_t k = 0; k < mixed.size(); ++k) {
        mixed[k] = static_cast<std::uint8_t>(
            std::lround((1.0f - t) * static_cast<float>(a[k]) + t * static_cast<float>(b[k])));
    }
    return mixed;
}

}  // namespace

std::vector<CutSegment> section_contour(std::span<const Triangle> triangles,
                                        std::span<const view::LitVertex> vertices,
                                        std::span<const VertexColour> colours, const CutPlane& plane) {
    std::vector<float> side(vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        side[v] = plane.normal.dot(vertices[v].position - plane.origin);
    }
    std::vector<CutSegment> contour;
    for (const Triangle& triangle : triangles) {
        std::array<CutSegment::End, 2> ends;
        std::size_t found = 0;
        for (std::size_t corner = 0; corner < 3 && found < 2; ++corner) {
            const std::uint32_t i = triangle[corner], j = triangle[(corner + 1) % 3];
            // Half-open, so that a vertex in the plane belongs to one side.
            if ((side[i] < 0.0f) == (side[j] < 0.0f)) {
                continue;
            }
            // From the same end in both triangles of the edge, so that their segments meet in one point.
            const auto [low, high] = std::minmax(i, j);
            const float t = side[low] / (side[low] - side[high]);
            const view::LitVertex& a = vertices[low];
            const view::LitVertex& b = vertices[high];
            Vec3f inward = -(a.normal + t * (b.normal - a.normal));
            inward -= inward.dot(plane.normal) * plane.normal;
            const float length = inward.norm();
            ends[found++] = {a.position + t * (b.position - a.position),
                             length > 1e-6f ? Vec3f(inward / length) : Vec3f::Zero(),
                             blend(colours[low], colours[high], t)};
        }
        if (found == 2) {
            contour.push_back({ends[0], ends[1]});
        }
    }
    return contour;
}

std::vector<CutVertex> section_band(std::span<const CutSegment> contour, float width) {
    std::vector<CutVertex> band;
    band.reserve(6 * contour.size());
    for (const CutSegment& segment : contour) {
        const CutVertex a{segment.a.position, segment.a.colour};
        const CutVertex b{segment.b.position, segment.b.colour};
        const CutVertex c{segment.a.position + width * segment.a.inward, segment.a.colour};
        const CutVertex d{segment.b.position + width * segment.b.inward, segment.b.colour};
        band.insert(band.end(), {a, b, c, b, d, c});
    }
    return band;
}

std::vector<CutVertex> section_fan(std::span<const CutSegment> contour) {
    std::vector<CutVertex> fan;
    fan.reserve(3 * contour.size());
    for (const CutSegment& segment : contour) {
        fan.push_back({contour.front().a.position, {}});
        fan.push_back({segment.a.position, {}});
        fan.push_back({segment.b.position, {}});
    }
    return fan;
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
