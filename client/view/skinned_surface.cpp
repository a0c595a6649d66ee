// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/skinned_surface.hpp"

#include <algorithm>
#include <utility>

namespace eti::view {

namespace {

Vec3f unit(const Vec3f& normal) {
    const float length = normal.norm();
    // Lengths are areas [m^2]; triangles of a tenth of a millimetre still give 1e-8.
    return length > 1e-20f ? Vec3f(normal / length) : Vec3f::UnitZ();
}

// Entries without weight name a frame that has weight, so that a test for moved frames need not check
// weights.
std::shared_ptr<const bus::RestSurface> with_used_frames(bus::RestSurface model) {
    for (SkinWeights& skin : model.skin) {
        const auto heaviest = std::ranges::max_element(skin.weight) - skin.weight.begin();
        for (std::size_t k = 0; k < frames_per_point; ++k) {
            if (!(skin.weight[k] > 0.0f)) {
                skin.frame[k] = skin.frame[static_cast<std::size_t>(heaviest)];
            }
        }
    }
    return std::make_shared<const bus::RestSurface>(std::move(model));
}

}  // namespace

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
        vertex.normal = unit(vertex.normal);
    }
}

SkinnedSurface::SkinnedSurface(bus::RestSurface model)
    : model_(with_used_frames(std::move(model))),
      vertices_(model_->mesh.vertices.size()),
      moved_(vertices_.size()),
      tilted_(vertices_.size()) {
    std::vector<std::uint8_t> carries(std::size_t{model_->highest_frame} + 1, 0);
    for (const SkinWeights& skin : model_->skin) {
        for (const std::uint16_t frame : skin.frame) {
            carries[frame] = 1;
        }
    }
    for (std::size_t f = 0; f < carries.size(); ++f) {
        if (carries[f] != 0) {
            used_frames_.push_back(static_cast<std::uint16_t>(f));
        }
    }
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
        vertices_[v].position = model_->mesh.vertices[v];
    }
    recompute_normals(model_->mesh.triangles, vertices_);
}

bool SkinnedSurface::update(std::span<const FrameMap> frames, std::span<const std::uint8_t> moved) {
    const bool stale = std::any_of(used_frames_.begin(), used_frames_.end(),
                                   [&](std::uint16_t frame) { return moved[frame] != 0; });
    if (!stale) {
        return false;
    }
    skin_moved(frames, moved);
    update_normals();
    revision_ = next_revision();
    return true;
}

void SkinnedSurface::skin_moved(std::span<const FrameMap> frames, std::span<const std::uint8_t> moved) {
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
        const SkinWeights& skin = model_->skin[v];
        moved_[v] = std::uint8_t{0};
        for (const std::uint16_t frame : skin.frame) {
            moved_[v] |= moved[frame];
        }
        if (moved_[v] != 0) {
            vertices_[v].position = skin_point(model_->mesh.vertices[v], skin, frames);
        }
    }
}

// Updates only vertices with a moved triangle; each sums over all its triangles in order, as
// recompute_normals() does, so that results are bitwise identical.
void SkinnedSurface::update_normals() {
    std::ranges::fill(tilted_, std::uint8_t{0});
    for (const auto& [a, b, c] : model_->mesh.triangles) {
        if ((moved_[a] | moved_[b] | moved_[c]) != 0) {
            tilted_[a] = tilted_[b] = tilted_[c] = 1;
        }
    }
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
        if (tilted_[v] != 0) {
            vertices_[v].normal.setZero();
        }
    }
    for (const Triangle& triangle : model_->mesh.triangles) {
        const auto [a, b, c] = triangle;
        if ((tilted_[a] | tilted_[b] | tilted_[c]) == 0) {
            continue;
        }
        const Vec3f& origin = vertices_[a].position;
        const Vec3f doubled_area = (vertices_[b].position - origin).cross(vertices_[c].position - origin);
        for (const std::uint32_t v : triangle) {
            if (tilted_[v] != 0) {
                vertices_[v].normal += doubled_area;
            }
        }
    }
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
        if (tilted_[v] != 0) {
            vertices_[v].normal = unit(vertices_[v].normal);
        }
    }
}

}  // namespace eti::view
