// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/model/tools.hpp"

namespace eti {

namespace {

/// A closed tube of quads: rings of equal size, capped at both ends by fans about the rings' centroids.
void add_loft(TriangleMesh& mesh, const std::vector<std::vector<Vec3f>>& rings) {
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    const auto count = static_cast<std::uint32_t>(rings.front().size());
    for (const auto& ring : rings) {
        mesh.vertices.insert(mesh.vertices.end(), ring.begin(), ring.end());
    }
    const auto at = [&](std::size_t ring, std::uint32_t k) {
        return base + static_cast<std::uint32_t>(ring) * count + k % count;
    };
    for (std::size_t r = 0; r + 1 < rings.size(); ++r) {
        for (std::uint32_t k = 0; k < count; ++k) {
            mesh.triangles.push_back({at(r, k), at(r, k + 1), at(r + 1, k + 1)});
            mesh.triangles.push_back({at(r, k), at(r + 1, k + 1), at(r + 1, k)});
        }
    }
    for (const std::size_t end : {std::size_t{0}, rings.size() - 1}) {
        Vec3f centre = Vec3f::Zero();
        for (const Vec3f& v : rings[end]) {
            centre += v / static_cast<float>(count);
        }
        const auto hub = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(centre);
        for (std::uint32_t k = 0; k < count; ++k) {
            if (end == 0) {
                mesh.triangles.push_back({hub, at(end, k + 1), at(end, k)});
            } else {
                mesh.triangles.push_back({hub, at(end, k), at(end, k + 1)});
            }
        }
    }
}

}  // namespace

TriangleMesh laryngoscope_mesh(const Laryngoscope& scope) {
    const bool smaller = scope.blade == Blade::miller_0;
    const float half_width_base = smaller ? 4.0e-3f : 5.0e-3f;
    const float half_width_tip = smaller ? 3.0e-3f : 3.5e-3f;
    constexpr float thickness = 1.5e-3f;
    constexpr float flange_height = 4.0e-3f;
    constexpr int stations = 24;
    TriangleMesh mesh;
    // The blade: a plate on the tongue's side of the capsules (their crest at y = radius), with a low
    // flange along the patient's right (-x); the channel below the plate stays open for the view.
    std::vector<std::vector<Vec3f>> blade;
    for (int s = 0; s <= stations; ++s) {
        const float u = static_cast<float>(s) / stations;
        const float z = u * scope.blade_length;
        const float half = half_width_base + (half_width_tip - half_width_base) * u;
        const float crest = scope.capsules[1].radius + (scope.capsules[2].radius - scope.capsules[1].radius) * std::min(1.0f, u / 0.6f);
        // The last 8 mm turn up by a millimetre, as the straight blade's lip does.
        const float lip = 1.0e-3f * std::pow(std::max(0.0f, (z - scope.blade_length + 8e-3f) / 8e-3f), 2.0f);
        const float top = crest + lip;
        const float flange = flange_height * (1.0f - std::pow(u, 4.0f));
        const float arch = 0.8e-3f;
        blade.push_back({{-half, top - arch, z},
                         {-0.5f * half, top - 0.25f * arch, z},
                         {0, top, z},
                         {0.5f * half, top - 0.25f * arch, z},
                         {half, top - arch, z},
                         {half, top - arch - thickness, z},
                         {0.5f * half, top - 0.25f * arch - thickness, z},
                         {0, top - thickness, z},
                         {-0.5f * half, top - 0.25f * arch - thickness, z},
                         {-half + thickness, top - arch - thickness, z},
                         {-half + thickness, top - arch - thickness - flange, z},
                         {-half, top - arch - thickness - flange, z}});
        std::reverse(blade.back().begin(), blade.back().end());
    }
    add_loft(mesh, blade);
    std::vector<std::vector<Vec3f>> handle;
    const Capsule& grip = scope.capsules[0];
    for (const float shrink : {-2.0f, -1.0f, 0.0f, 1.0f, 2.0f}) {
        // Bevelled ends.
        const float y = shrink < 0 ? grip.a.y() + (shrink < -1 ? -6e-3f : -4e-3f)
                                   : (shrink > 0 ? grip.b.y() + (shrink > 1 ? 6e-3f : 4e-3f) : 0.5f * (grip.a.y() + grip.b.y()));
        const float radius = std::fabs(shrink) > 1 ? 0.8f * grip.radius : grip.radius;
        std::vector<Vec3f> ring;
        for (int k = 0; k < 24; ++k) {
            const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(k) / 24.0f;
            ring.emplace_back(radius * std::sin(angle), y, radius * std::cos(angle));
        }
        handle.push_back(ring);
    }
    add_loft(mesh, handle);
    return mesh;
}

}  // namespace eti
