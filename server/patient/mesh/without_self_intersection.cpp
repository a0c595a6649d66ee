// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/mesh/without_self_intersection.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/mesh/intersect.hpp"
#include "common/mesh/point_grid.hpp"

namespace eti {

namespace {

using Pairs = std::vector<std::array<std::uint32_t, 2>>;

/// Intersecting pairs of triangles of a mesh, updated as vertices move.
class Crossings {
  public:
    explicit Crossings(const TriangleMesh& mesh) : Crossings(mesh, self_intersections(mesh)) {}
    /// For a mesh whose pairs are known.
    Crossings(const TriangleMesh& mesh, Pairs pairs)
        : mesh_(mesh), vertices_(mesh.vertices), pairs_(std::move(pairs)) {}

    [[nodiscard]] const Pairs& pairs() const { return pairs_; }

    /// Call after vertices moved: only triangles at these can start or stop to intersect.
    void update() {
        std::vector<std::uint8_t> moved(mesh_.triangles.size());
        for (std::size_t t = 0; t < moved.size(); ++t) {
            moved[t] = std::ranges::any_of(
                mesh_.triangles[t], [&](std::uint32_t v) { return mesh_.vertices[v] != vertices_[v]; });
        }
        std::erase_if(pairs_, [&](const auto& pair) { return (moved[pair[0]] | moved[pair[1]]) != 0; });
        const Pairs found = self_intersections(mesh_, moved);
        pairs_.insert(pairs_.end(), found.begin(), found.end());
        std::ranges::sort(pairs_);
        vertices_ = mesh_.vertices;
    }

  private:
    const TriangleMesh& mesh_;
    std::vector<Vec3f> vertices_;
    Pairs pairs_;
};

/// Relaxes the vertices of intersecting triangles towards their neighbours' mean. This separates a few
/// intersections that are far smaller than the triangles of a simplified surface. Returns whether all were.
bool relax_crossings(TriangleMesh& mesh, const Pairs& known) {
    constexpr int rounds = 8;
    Crossings crossings(mesh, known);
    std::vector<Vec3f> sum(mesh.vertices.size());
    std::vector<float> count(mesh.vertices.size());
    for (int round = 0; round < rounds; ++round) {
        if (crossings.pairs().empty()) {
            return true;
        }
        std::fill(sum.begin(), sum.end(), Vec3f::Zero());
        std::fill(count.begin(), count.end(), 0.0f);
        for (const Triangle& t : mesh.triangles) {
            for (std::size_t k = 0; k < 3; ++k) {
                sum[t[k]] += mesh.vertices[t[(k + 1) % 3]];
                count[t[k]] += 1.0f;
            }
        }
        std::vector<std::uint8_t> moved(mesh.vertices.size(), 0);
        for (const auto& pair : crossings.pairs()) {
            for (const std::uint32_t t : pair) {
                for (const std::uint32_t v : mesh.triangles[t]) {
                    if (moved[v] == 0) {
                        moved[v] = 1;
                        mesh.vertices[v] = 0.5f * (mesh.vertices[v] + sum[v] / count[v]);
                    }
                }
            }
        }
        crossings.update();
    }
    return crossings.pairs().empty();
}

}  // namespace

void smooth_without_self_intersection(TriangleMesh& mesh, int iterations) {
    constexpr int rounds = 8;
    constexpr int rings = 3;
    const std::vector<Vec3f> rough = mesh.vertices;
    smooth(mesh, iterations);
    std::vector<std::uint8_t> kept(rough.size(), 0);
    Crossings crossings(mesh);
    for (int round = 0; round < rounds && !crossings.pairs().empty(); ++round) {
        for (const auto& pair : crossings.pairs()) {
            for (const std::uint32_t t : pair) {
                for (const std::uint32_t v : mesh.triangles[t]) {
                    kept[v] = 1;
                }
            }
        }
        for (int ring = 0; ring < rings; ++ring) {
            const std::vector<std::uint8_t> core = kept;
            for (const Triangle& t : mesh.triangles) {
                if ((core[t[0]] | core[t[1]] | core[t[2]]) != 0) {
                    kept[t[0]] = kept[t[1]] = kept[t[2]] = 1;
                }
            }
        }
        for (std::size_t v = 0; v < kept.size(); ++v) {
            if (kept[v] != 0) {
                mesh.vertices[v] = rough[v];
            }
        }
        if (round + 1 < rounds) {
            crossings.update();
        }
    }
}

TriangleMesh simplify_without_self_intersection(const TriangleMesh& mesh, const SimplifySettings& settings) {
    constexpr int rounds = 12;
    constexpr float much = 1e6f;
    TriangleMesh coarse = simplify(mesh, settings);
    TriangleMesh relaxed = coarse;
    Pairs crossings = self_intersections(coarse);
    if (relax_crossings(relaxed, crossings)) {
        return relaxed;
    }
    // Iterations work on a mesh that is fine enough and not a hundred times too large.
    SimplifySettings finer = settings;
    finer.triangles = 4 * settings.triangles;
    TriangleMesh fine = simplify(mesh, finer);
    relax_crossings(fine, self_intersections(fine));
    const PointGrid points(fine.vertices, 2e-3f);
    std::vector<float> importance(fine.vertices.size(), 1.0f);
    if (!settings.importance.empty()) {
        // A kept vertex is close to its original position.
        const PointGrid before(mesh.vertices, 2e-3f);
        for (std::size_t i = 0; i < fine.vertices.size(); ++i) {
            float nearest = 4e-6f;
            before.within(fine.vertices[i], 2e-3f, [&](std::uint32_t k, float squared) {
                if (squared < nearest) {
                    nearest = squared;
                    importance[i] = settings.importance[k];
                }
            });
        }
    }
    for (int round = 0; round < rounds; ++round) {
        for (const auto& pair : crossings) {
            for (const std::uint32_t t : pair) {
                const Vec3f& a = coarse.vertices[coarse.triangles[t][0]];
                const Vec3f& b = coarse.vertices[coarse.triangles[t][1]];
                const Vec3f& c = coarse.vertices[coarse.triangles[t][2]];
                const Vec3f middle = (a + b + c) / 3.0f;
                const float reach =
                    1.2f * std::max({(a - middle).norm(), (b - middle).norm(), (c - middle).norm()});
                points.within(middle, reach, [&](std::uint32_t i, float) { importance[i] = much; });
            }
        }
        coarse = simplify(fine, {.triangles = settings.triangles, .importance = importance});
        relaxed = coarse;
        crossings = self_intersections(coarse);
        if (relax_crossings(relaxed, crossings)) {
            break;
        }
    }
    return relaxed;
}

}  // namespace eti
