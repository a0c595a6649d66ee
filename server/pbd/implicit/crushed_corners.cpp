// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Crushed corners of ImplicitMesh.
#include "server/pbd/implicit/implicit_mesh.hpp"

namespace eti::pbd {

void ImplicitMesh::add_crushed_corners(Part& part, std::uint32_t first, std::uint32_t end) const {
    const auto* const blocks = hexahedra_.blocks().data();
    const float bulk = 0.125f / hexahedron_ratio_;  // over the shear modulus, of one of eight corners
    for (std::uint32_t b = first; b < end; ++b) {
        const Hexahedra::Block& block = blocks[b];
        for (std::size_t lane = 0; lane < Hexahedra::lanes; ++lane) {
            const bool crushed = hexahedron_element_[b].smallest_corner[lane] < settings.crushed_corner;
            if (!crushed || block.stiffness[lane] == 0.0f) {
                continue;
            }
            for (unsigned v = 0; v < 8; ++v) {
                std::array<std::uint32_t, 4> corner = {block.corner[v][lane] / 4};
                for (unsigned axis = 0; axis < 3; ++axis) {
                    corner[axis + 1] = block.corner[v ^ (1u << axis)][lane] / 4;
                }
                // An odd number of turned axes makes the corner's edges left-handed.
                const float hand = ((v ^ v >> 1 ^ v >> 2) & 1u) != 0 ? -1.0f : 1.0f;
                add_if_crushed(part, corner, hand * block.inverse_determinant[lane],
                               bulk * block.stiffness[lane]);
            }
        }
    }
}

void ImplicitMesh::add_if_crushed(Part& part, const std::array<std::uint32_t, 4>& corner,
                                  float inverse_determinant, float stiffness) const {
    std::array<Vec3f, 3> edge;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        edge[axis] = (x_[corner[axis + 1]] - x_[corner[0]]).head<3>();
    }
    const float lost = settings.crushed_corner - inverse_determinant * edge[0].dot(edge[1].cross(edge[2]));
    if (!(lost > 0.0f)) {
        return;
    }
    CrushedCorner crushed{.corner = corner, .slope = {}, .stiffness = stiffness};
    crushed.slope[0].setZero();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        crushed.slope[axis + 1].setZero();
        crushed.slope[axis + 1].head<3>() =
            inverse_determinant * edge[(axis + 1) % 3].cross(edge[(axis + 2) % 3]);
        crushed.slope[0] -= crushed.slope[axis + 1];
    }
    for (std::size_t n = 0; n < 4; ++n) {
        const std::uint32_t k = corner[n];
        const Eigen::Vector4f& g = crushed.slope[n];
        part.gradient[k] -= stiffness * lost * g;
        part.square[k] += stiffness * g.cwiseProduct(g);
        part.mixed[k].head<3>() += stiffness * Vec3f(g.y() * g.z(), g.z() * g.x(), g.x() * g.y());
    }
    part.crushed.push_back(crushed);
}

void ImplicitMesh::apply(const CrushedCorner& crushed, const Wide& along, Wide& image) {
    float change = 0.0f;
    for (std::size_t n = 0; n < 4; ++n) {
        change += crushed.slope[n].dot(along[crushed.corner[n]]);
    }
    for (std::size_t n = 0; n < 4; ++n) {
        image[crushed.corner[n]] += crushed.stiffness * change * crushed.slope[n];
    }
}

}  // namespace eti::pbd
