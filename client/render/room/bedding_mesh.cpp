// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/room/bedding_mesh.hpp"

#include <cstddef>
#include <vector>

#include "client/render/mesh/gpu_mesh.hpp"

namespace eti::render {
namespace {

struct PackedBeddingVertex {
    float height;
    std::uint32_t normal;  // ten bits per component
    VertexColour colour;
};
static_assert(sizeof(PackedBeddingVertex) == 12 && offsetof(PackedBeddingVertex, colour) == 8);

std::vector<PackedBeddingVertex> packed(const Bedding& bedding, std::size_t count) {
    std::vector<PackedBeddingVertex> vertices;
    vertices.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
        const view::LitVertex& vertex = bedding.vertices()[k];
        vertices.push_back({vertex.position.y(), packed_normal(vertex.normal), bedding.colours()[k]});
    }
    return vertices;
}

}  // namespace

BeddingMesh::BeddingMesh(const Bedding& bedding) {
    glBindVertexArray(array_.name());
    std::vector<Eigen::Vector2f> places;
    for (const view::LitVertex& vertex : bedding.vertices()) {
        places.emplace_back(vertex.position.x(), vertex.position.z());
    }
    upload(GL_ARRAY_BUFFER, places_, places, GL_STATIC_DRAW);
    attribute(Attribute::position, 2, GL_FLOAT, GL_FALSE, sizeof(Eigen::Vector2f), 0);
    upload(GL_ARRAY_BUFFER, surface_, packed(bedding, places.size()), GL_DYNAMIC_DRAW);
    constexpr GLsizei stride = sizeof(PackedBeddingVertex);
    attribute(Attribute::height, 1, GL_FLOAT, GL_FALSE, stride, 0);
    attribute(Attribute::normal, 4, GL_INT_2_10_10_10_REV, GL_TRUE, stride, 4);
    attribute(Attribute::colour, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride, 8);
    std::vector<Triangle> triangles(bedding.triangles().begin(), bedding.triangles().end());
    const std::vector<Triangle> coarse = bedding.coarse_triangles();
    fine_ = {static_cast<GLsizei>(3 * triangles.size()), 0};
    coarse_ = {static_cast<GLsizei>(3 * coarse.size()), triangles.size() * sizeof(Triangle)};
    triangles.insert(triangles.end(), coarse.begin(), coarse.end());
    upload(GL_ELEMENT_ARRAY_BUFFER, indices_, triangles, GL_STATIC_DRAW);
    glBindVertexArray(0);
}

void BeddingMesh::update(const Bedding& bedding, int rows) {
    const auto vertices = packed(bedding, static_cast<std::size_t>(rows * Bedding::columns));
    glBindBuffer(GL_ARRAY_BUFFER, surface_.name());
    glBufferSubData(GL_ARRAY_BUFFER, 0,
                    static_cast<GLsizeiptr>(vertices.size() * sizeof(PackedBeddingVertex)), vertices.data());
}

void BeddingMesh::draw(bool coarse) const {
    const Range& range = coarse ? coarse_ : fine_;
    glBindVertexArray(array_.name());
    glDrawElements(GL_TRIANGLES, range.count, GL_UNSIGNED_INT, buffer_offset(range.offset));
}

}  // namespace eti::render
