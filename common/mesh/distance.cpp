// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/mesh/distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/mesh/closest_point.hpp"
#include "common/mesh/isosurface.hpp"

namespace eti {
namespace {

constexpr std::uint32_t no_triangle = std::numeric_limits<std::uint32_t>::max();

/// Propagates the closest triangle from node to node in order of distance (a closest-point variant of fast
/// marching). Distances are exact for the triangle assigned to a node, so errors do not accumulate as in
/// first-order schemes.
class Spread {
  public:
    Spread(const TriangleMesh& mesh, DistanceGrid& grid, float band)
        : mesh_(mesh), grid_(grid), closest_(grid.value.size(), no_triangle) {
        // Half a spacing per bucket orders the visits well enough; a node that improves later is revisited.
        buckets_.resize(static_cast<std::size_t>(band / bucket_width()) + 2);
        balls_.reserve(mesh.triangles.size());
        for (const Triangle& t : mesh.triangles) {
            const Vec3f &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
            const Vec3f centre = (a + b + c) / 3.0f;
            const float squared = std::max(
                {(a - centre).squaredNorm(), (b - centre).squaredNorm(), (c - centre).squaredNorm()});
            balls_.push_back({centre, std::sqrt(squared)});
        }
    }

    void run() {
        for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
            seed(t);
        }
        for (std::size_t b = 0; b < buckets_.size(); ++b) {
            // Visits may add to the bucket being emptied, never to an earlier one.
            current_ = b;
            for (std::size_t i = 0; i < buckets_[b].size(); ++i) {
                const Visit visit = buckets_[b][i];
                if (grid_.value[visit.node] == visit.distance) {
                    hand_on(visit);
                }
            }
            std::vector<Visit>().swap(buckets_[b]);
        }
    }

  private:
    struct Visit {
        std::size_t node;
        float distance;
    };
    struct Ball {
        Vec3f centre;
        float radius;
    };

    [[nodiscard]] float bucket_width() const { return 0.5f * grid_.spacing; }

    void offer(std::size_t node, const Vec3f& position, std::uint32_t triangle) {
        // Most triangles are farther than the closest so far. The hundredth of a spacing is for rounding.
        const Ball& ball = balls_[triangle];
        const float reach = grid_.value[node] + ball.radius + 0.01f * grid_.spacing;
        if ((position - ball.centre).squaredNorm() > reach * reach) {
            return;
        }
        const Triangle& t = mesh_.triangles[triangle];
        const Vec3f &a = mesh_.vertices[t[0]], &b = mesh_.vertices[t[1]], &c = mesh_.vertices[t[2]];
        ClosestPoint closest = closest_on_triangle(position, a, b, c);
        if (closest.feature == Feature::face) {
            // One division instead of a scale: patients and their posed shells keep these bits.
            const auto& [of_a, of_b, of_c] = closest.areas;
            closest.point = a + (of_b * (b - a) + of_c * (c - a)) / (of_a + of_b + of_c);
        }
        const float distance = (position - closest.point).norm();
        if (distance < grid_.value[node]) {
            grid_.value[node] = distance;
            closest_[node] = triangle;
            const auto bucket = static_cast<std::size_t>(distance / bucket_width());
            buckets_[std::max(bucket, current_)].push_back({node, distance});
        }
    }

    /// Seeds the nodes of all cells that the triangle's bounding box overlaps, extended by one node on each
    /// side: near the surface, the closest triangle need not be the closest of a neighbouring node.
    void seed(std::uint32_t triangle) {
        const Triangle& t = mesh_.triangles[triangle];
        const Vec3f &a = mesh_.vertices[t[0]], &b = mesh_.vertices[t[1]], &c = mesh_.vertices[t[2]];
        const Vec3f low = (a.cwiseMin(b).cwiseMin(c) - grid_.origin) / grid_.spacing;
        const Vec3f high = (a.cwiseMax(b).cwiseMax(c) - grid_.origin) / grid_.spacing;
        std::array<int, 3> first{};
        std::array<int, 3> last{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto i = static_cast<Eigen::Index>(axis);
            first[axis] = std::max(0, static_cast<int>(std::floor(low[i])) - 1);
            last[axis] = std::min(grid_.size[axis] - 1, static_cast<int>(std::ceil(high[i])) + 1);
        }
        for (int z = first[2]; z <= last[2]; ++z) {
            for (int y = first[1]; y <= last[1]; ++y) {
                for (int x = first[0]; x <= last[0]; ++x) {
                    offer(grid_.index(x, y, z), grid_.node(x, y, z), triangle);
                }
            }
        }
    }

    void hand_on(const Visit& visit) {
        const auto width = static_cast<std::size_t>(grid_.size[0]);
        const auto height = static_cast<std::size_t>(grid_.size[1]);
        const int x0 = static_cast<int>(visit.node % width);
        const int y0 = static_cast<int>(visit.node / width % height);
        const int z0 = static_cast<int>(visit.node / (width * height));
        const std::uint32_t triangle = closest_[visit.node];
        for (int z = std::max(z0 - 1, 0); z <= std::min(z0 + 1, grid_.size[2] - 1); ++z) {
            for (int y = std::max(y0 - 1, 0); y <= std::min(y0 + 1, grid_.size[1] - 1); ++y) {
                for (int x = std::max(x0 - 1, 0); x <= std::min(x0 + 1, grid_.size[0] - 1); ++x) {
                    const std::size_t node = grid_.index(x, y, z);
                    // A node that is closer by more than one spacing already has a better triangle.
                    if (closest_[node] != triangle && grid_.value[node] > visit.distance - grid_.spacing) {
                        offer(node, grid_.node(x, y, z), triangle);
                    }
                }
            }
        }
    }

    const TriangleMesh& mesh_;
    DistanceGrid& grid_;
    std::vector<Ball> balls_;  ///< around each triangle
    std::vector<std::uint32_t> closest_;
    std::vector<std::vector<Visit>> buckets_;
    std::size_t current_ = 0;  ///< bucket being emptied
};

/// Side of the origin on which the line from (y1, z1) to (y2, z2) passes. Exactly antisymmetric. Ties are
/// broken as if the origin were shifted by an infinitesimal, so a ray through a shared edge or vertex counts
/// once.
int side(double y1, double z1, double y2, double z2) {
    const double area = z1 * y2 - y1 * z2;
    if (area != 0.0) {
        return area > 0.0 ? 1 : -1;
    }
    if (z1 != z2) {
        return z2 > z1 ? 1 : -1;
    }
    if (y1 != y2) {
        return y1 > y2 ? 1 : -1;
    }
    return 0;
}

/// Negates distances where a ray along x has crossed the mesh an odd number of times.
void sign_by_parity(const TriangleMesh& mesh, DistanceGrid& grid) {
    std::vector<std::uint8_t> crossings(grid.value.size(), 0);
    const double spacing = static_cast<double>(grid.spacing);
    for (const Triangle& t : mesh.triangles) {
        std::array<Vec3d, 3> p;
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = (mesh.vertices[t[k]] - grid.origin).cast<double>() / spacing;
        }
        const Vec3d low = p[0].cwiseMin(p[1]).cwiseMin(p[2]);
        const Vec3d high = p[0].cwiseMax(p[1]).cwiseMax(p[2]);
        for (int z = std::max(0, static_cast<int>(std::floor(low.z())));
             z <= std::min(grid.size[2] - 1, static_cast<int>(std::ceil(high.z()))); ++z) {
            for (int y = std::max(0, static_cast<int>(std::floor(low.y())));
                 y <= std::min(grid.size[1] - 1, static_cast<int>(std::ceil(high.y()))); ++y) {
                const Vec3d ray(0.0, y, z);
                std::array<double, 3> area{};
                std::array<int, 3> turn{};
                for (std::size_t k = 0; k < 3; ++k) {
                    const Vec3d a = p[(k + 1) % 3] - ray;
                    const Vec3d b = p[(k + 2) % 3] - ray;
                    area[k] = a.z() * b.y() - a.y() * b.z();
                    turn[k] = side(a.y(), a.z(), b.y(), b.z());
                }
                const double total = area[0] + area[1] + area[2];
                if (turn[0] == 0 || turn[0] != turn[1] || turn[1] != turn[2] || total == 0.0) {
                    continue;
                }
                const double x = (area[0] * p[0].x() + area[1] * p[1].x() + area[2] * p[2].x()) / total;
                const int next = std::max(0, static_cast<int>(std::ceil(x)));
                if (next < grid.size[0]) {
                    crossings[grid.index(next, y, z)] ^= 1;
                }
            }
        }
    }
    for (int z = 0; z < grid.size[2]; ++z) {
        for (int y = 0; y < grid.size[1]; ++y) {
            std::uint8_t inside = 0;
            for (int x = 0; x < grid.size[0]; ++x) {
                const std::size_t node = grid.index(x, y, z);
                inside ^= crossings[node];
                grid.value[node] = inside != 0 ? -grid.value[node] : grid.value[node];
            }
        }
    }
}

}  // namespace

DistanceGrid redistance(const DistanceGrid& field, float band) {
    DistanceGrid grid{field.origin, field.spacing, field.size, {}};
    grid.value.assign(field.value.size(), band);
    Spread(isosurface(field, 0.0f, Border::open), grid, band).run();
    for (std::size_t i = 0; i < grid.value.size(); ++i) {
        if (field.value[i] < 0.0f) {
            grid.value[i] = -grid.value[i];
        }
    }
    return grid;
}

DistanceGrid mesh_distance(const TriangleMesh& mesh, const Vec3f& origin, float spacing,
                           const std::array<int, 3>& size, float band) {
    DistanceGrid grid{origin, spacing, size, {}};
    grid.value.assign(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
                          static_cast<std::size_t>(size[2]),
                      band);
    Spread(mesh, grid, band).run();
    sign_by_parity(mesh, grid);
    return grid;
}

}  // namespace eti
