// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cmath>
#include <numbers>

#include "common/mesh/distance_grid.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti::test {

/// Shapes with closed forms: signed distance, volume and area. Sizes in metres, like an airway's.
struct Sphere {
    Vec3f centre = Vec3f(0.0013f, -0.0007f, 0.0004f);
    float radius = 0.010f;
    [[nodiscard]] float operator()(const Vec3f& p) const { return (p - centre).norm() - radius; }
    [[nodiscard]] double volume() const { return 4.0 / 3.0 * std::numbers::pi * std::pow(double{radius}, 3); }
    [[nodiscard]] double area() const { return 4.0 * std::numbers::pi * std::pow(double{radius}, 2); }
    static constexpr long euler_characteristic = 2;
    static constexpr float half_extent = 0.0125f;
};

struct Torus {
    float ring = 0.009f;  ///< centre to tube's centre line
    float tube = 0.003f;
    [[nodiscard]] float operator()(const Vec3f& p) const {
        return std::hypot(std::hypot(p.x(), p.y()) - ring, p.z()) - tube;
    }
    [[nodiscard]] double volume() const {
        return 2.0 * std::numbers::pi * std::numbers::pi * double{ring} * std::pow(double{tube}, 2);
    }
    [[nodiscard]] double area() const {
        return 4.0 * std::numbers::pi * std::numbers::pi * double{ring} * double{tube};
    }
    static constexpr long euler_characteristic = 0;
    static constexpr float half_extent = 0.0135f;
};

/// Samples a function on a cubic grid around the origin.
template <typename Function>
DistanceGrid sample_grid(const Function& function, float half_extent, float spacing) {
    const int count = 2 * static_cast<int>(std::ceil(half_extent / spacing)) + 1;
    DistanceGrid grid;
    grid.spacing = spacing;
    grid.size = {count, count, count};
    grid.origin = Vec3f::Constant(-0.5f * spacing * static_cast<float>(count - 1));
    for (int z = 0; z < count; ++z) {
        for (int y = 0; y < count; ++y) {
            for (int x = 0; x < count; ++x) {
                grid.value.push_back(function(grid.node(x, y, z)));
            }
        }
    }
    return grid;
}

/// An octahedron with vertices at distance `size` from the origin.
inline TriangleMesh octahedron(float size) {
    TriangleMesh mesh;
    for (int axis = 0; axis < 3; ++axis) {
        for (const float sign : {size, -size}) {
            mesh.vertices.push_back(sign * Vec3f::Unit(axis));
        }
    }
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    return mesh;
}

}  // namespace eti::test
