// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/sight/sky_visibility.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "client/view/skinned_surface.hpp"

namespace eti::view {
namespace {

constexpr int largest_map = 2048;

// Height map along one direction.
class HeightMap {
  public:
    HeightMap(std::span<const LitVertex> vertices, const Vec3f& direction, float cell) : up_(direction) {
        right_ = direction.unitOrthogonal();
        forward_ = direction.cross(right_);
        Vec3f low = Vec3f::Constant(std::numeric_limits<float>::max());
        Vec3f high = -low;
        for (const LitVertex& vertex : vertices) {
            const Vec3f local = raw(vertex.position);
            low = low.cwiseMin(local);
            high = high.cwiseMax(local);
        }
        cell_ = std::max({cell, (high.x() - low.x()) / largest_map, (high.y() - low.y()) / largest_map});
        low_ = low;
        columns_ = static_cast<int>((high.x() - low.x()) / cell_) + 1;
        rows_ = static_cast<int>((high.y() - low.y()) / cell_) + 1;
        height_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_),
                       std::numeric_limits<float>::lowest());
    }

    void cover(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
        const Vec3f p = local(a), q = local(b), r = local(c);
        raise(p);
        raise(q);
        raise(r);
        const float doubled = (q.x() - p.x()) * (r.y() - p.y()) - (q.y() - p.y()) * (r.x() - p.x());
        if (std::abs(doubled) < 1e-6f) {
            return;
        }
        const int x0 = static_cast<int>(std::min({p.x(), q.x(), r.x()}));
        const int x1 = static_cast<int>(std::max({p.x(), q.x(), r.x()}));
        const int y0 = static_cast<int>(std::min({p.y(), q.y(), r.y()}));
        const int y1 = static_cast<int>(std::max({p.y(), q.y(), r.y()}));
        for (int y = y0; y <= y1; ++y) {
            for (int x = x0; x <= x1; ++x) {
                const float px = static_cast<float>(x) + 0.5f - p.x(),
                            py = static_cast<float>(y) + 0.5f - p.y();
                const float u = (px * (r.y() - p.y()) - py * (r.x() - p.x())) / doubled;
                const float v = (py * (q.x() - p.x()) - px * (q.y() - p.y())) / doubled;
                if (u >= 0.0f && v >= 0.0f && u + v <= 1.0f) {
                    raise({px + p.x(), py + p.y(), p.z() + u * (q.z() - p.z()) + v * (r.z() - p.z())});
                }
            }
        }
    }

    // Whether `point` lies at most `slack` [m] beneath the highest surface over it.
    [[nodiscard]] bool open_above(const Vec3f& point, float slack) const {
        const Vec3f p = local(point);
        return p.z() + slack >= height_[cell_of(p)];
    }

  private:
    [[nodiscard]] Vec3f raw(const Vec3f& p) const { return {right_.dot(p), forward_.dot(p), up_.dot(p)}; }
    // Columns and rows in cells, height in metres.
    [[nodiscard]] Vec3f local(const Vec3f& p) const {
        const Vec3f q = raw(p) - low_;
        return {q.x() / cell_, q.y() / cell_, q.z()};
    }
    [[nodiscard]] std::size_t cell_of(const Vec3f& p) const {
        const int x = std::clamp(static_cast<int>(p.x()), 0, columns_ - 1);
        const int y = std::clamp(static_cast<int>(p.y()), 0, rows_ - 1);
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x);
    }
    void raise(const Vec3f& p) {
        float& height = height_[cell_of(p)];
        height = std::max(height, p.z());
    }

    Vec3f right_, forward_, up_, low_;
    float cell_ = 1.0f;
    int columns_ = 1, rows_ = 1;
    std::vector<float> height_;
};

}  // namespace

std::vector<float> sky_visibility(const TriangleMesh& mesh, int directions, float cell) {
    std::vector<LitVertex> vertices(mesh.vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        vertices[v].position = mesh.vertices[v];
    }
    recompute_normals(mesh.triangles, vertices);
    std::vector<float> seen(vertices.size(), 0.0f);
    std::vector<float> asked(vertices.size(), 0.0f);
    const float golden_angle = std::numbers::pi_v<float> * (3.0f - std::sqrt(5.0f));
    for (int i = 0; i < directions; ++i) {
        // Fibonacci lattice: nearly uniform directions on the sphere.
        const float z = 1.0f - (2.0f * static_cast<float>(i) + 1.0f) / static_cast<float>(directions);
        const float ring = std::sqrt(1.0f - z * z);
        const float turn = golden_angle * static_cast<float>(i);
        const Vec3f direction(ring * std::cos(turn), ring * std::sin(turn), z);
        HeightMap map(vertices, direction, cell);
        for (const Triangle& t : mesh.triangles) {
            map.cover(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
        }
        for (std::size_t v = 0; v < vertices.size(); ++v) {
            const float slope = vertices[v].normal.dot(direction);
            if (slope > 0.3f) {
                // Within a cell a surface of this slope rises by up to cell * tan; 0.3 gives 3.2.
                const float slack = 2.0f * cell * std::sqrt(1.0f - slope * slope) / slope + 0.5f * cell;
                asked[v] += 1.0f;
                seen[v] += map.open_above(vertices[v].position, slack) ? 1.0f : 0.0f;
            }
        }
    }
    for (std::size_t v = 0; v < seen.size(); ++v) {
        seen[v] = asked[v] > 0.0f ? seen[v] / asked[v] : 0.0f;
    }
    return seen;
}

}  // namespace eti::view
