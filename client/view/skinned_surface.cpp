// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/skinned_surface.hpp"

#include <algorithm>
#include <utility>

namespace eti::view {

void skin_vertices(const SurfaceModel& model, std::span<const FrameMap> frames,
                   std::span<LitVertex> vertices) {
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        vertices[v].position = skin_point(model.mesh.vertices[v], model.skin[v], frames);
    }
}

void recompute_normals(std::span<const Triangle> triangles, std::span<LitVertex> vertices) {
    for (LitVertex& vertex : vertices) {
        vertex.normal.setZero();
    }
    for (const Triangle& triangle : triangles) {
        LitVertex& a = vertices[triangle[0]];
        LitVertex& b = vertices[triangle[1]];
        LitVertex& c = vertices[triangle[2]];
        const Vec3f doubled_area = (b.position - a.position).cross(c.position - a.position);
        a.normal += doubled_area;
        b.normal += doubled_area;
        c.normal += doubled_area;
    }
    for (LitVertex& vertex : vertices) {
        const float length = vertex.normal.norm();
        // Lengths are areas [m^2]; triangles of a tenth of a millimetre still give 1e-8.
        vertex.normal = length > 1e-20f ? Vec3f(vertex.normal / length) : Vec3f::UnitZ();
    }
}

SkinnedSurface::SkinnedSurface(SurfaceModel model)
    : model_(std::move(model)), vertices_(model_.mesh.vertices.size()) {
    std::vector<std::uint8_t> carries(std::size_t{model_.highest_frame} + 1, 0);
    for (const SkinWeights& skin : model_.skin) {
        for (std::size_t k = 0; k < 4; ++k) {
            if (skin.weight[k] > 0.0f) {
                carries[skin.frame[k]] = 1;
            }
        }
    }
    for (std::size_t f = 0; f < carries.size(); ++f) {
        if (carries[f] != 0) {
            carriers_.push_back(static_cast<std::uint16_t>(f));
        }
    }
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
        vertices_[v].position = model_.mesh.vertices[v];
    }
    recompute_normals(model_.mesh.triangles, vertices_);
}

bool SkinnedSurface::update(std::span<const FrameMap> frames, std::span<const std::uint8_t> moved) {
    const bool stale = std::any_of(carriers_.begin(), carriers_.end(),
                                   [&](std::uint16_t frame) { return moved[frame] != 0; });
    if (!stale) {
        return false;
    }
    skin_vertices(model_, frames, vertices_);
    recompute_normals(model_.mesh.triangles, vertices_);
    ++revision_;
    return true;
}

}  // namespace eti::view
