// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/parts/parts.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

#include "common/mesh/closest_point.hpp"
#include "common/mesh/distance_grid.hpp"
#include "common/mesh/isosurface.hpp"
#include "common/mesh/simplify.hpp"
#include "common/process/files/atomic_file_writer.hpp"

namespace eti::devices {

namespace {

// Signed distances [m], negative inside; union by min, subtraction by max with the negative. Distances of
// subtractions are bounds, which suffices for their zero set.

float capsule(const Vec3f& p, const Vec3f& a, const Vec3f& b, float radius_a, float radius_b) {
    const float t = closest_on_segment(a, b, p);
    return (p - a - t * (b - a)).norm() - (radius_a + t * (radius_b - radius_a));
}

/// With flat ends.
float cylinder(const Vec3f& p, const Vec3f& a, const Vec3f& b, float radius) {
    const Vec3f axis = (b - a).normalized();
    const float along = (p - a).dot(axis);
    const float radial = (p - a - along * axis).norm() - radius;
    return std::max(radial, std::max(-along, along - (b - a).norm()));
}

float box(const Vec3f& p, const Vec3f& low, const Vec3f& high) {
    const Vec3f beyond = (low - p).cwiseMax(p - high);
    return beyond.cwiseMax(0.0f).norm() + std::min(beyond.maxCoeff(), 0.0f);
}

template <class Shape>
TriangleMesh surface_of(const Shape& shape, const Vec3f& low, const Vec3f& high, float spacing) {
    constexpr float border = 3.0f;      // nodes
    constexpr float most_error = 0.1f;  // of the spacing, permitted for simplification
    DistanceGrid grid;
    grid.spacing = spacing;
    grid.origin = low - Vec3f::Constant(border * spacing);
    const Vec3f extent = (high - low) / spacing;
    for (int k = 0; k < 3; ++k) {
        grid.size[static_cast<std::size_t>(k)] = static_cast<int>(std::ceil(extent[k] + 2.0f * border)) + 1;
    }
    grid.value.resize(static_cast<std::size_t>(grid.size[0]) * static_cast<std::size_t>(grid.size[1]) *
                      static_cast<std::size_t>(grid.size[2]));
    for (int z = 0; z < grid.size[2]; ++z) {
        for (int y = 0; y < grid.size[1]; ++y) {
            for (int x = 0; x < grid.size[0]; ++x) {
                grid.value[grid.index(x, y, z)] = shape(grid.node(x, y, z));
            }
        }
    }
    SimplifySettings fewer;
    fewer.triangles = 100;
    fewer.max_error = most_error * spacing;
    return simplify(isosurface(grid, 0.0f), fewer);
}

}  // namespace

TriangleMesh laryngoscope_part(const Laryngoscope& scope, const PartSettings& settings) {
    const Capsule &handle = scope.capsules[0], &proximal = scope.capsules[1], &distal = scope.capsules[2];
    const float bore = 0.5f * settings.stylus_diameter + settings.clearance;
    if (bore + settings.wall > handle.radius) {
        throw std::invalid_argument("a stylus of " + std::to_string(1e3f * settings.stylus_diameter) +
                                    " mm leaves the handle of " + std::to_string(2e3f * handle.radius) +
                                    " mm no wall; use a thinner one");
    }
    const Vec3f ball(0.0f, 0.0f, scope.blade_length - tip_ball_radius);
    const Vec3f up = Vec3f::UnitY();
    // The bore enters at the handle's upper end, where the device's arm has room.
    const Vec3f top = handle.b + (handle.radius + 1e-3f) * up;
    const Vec3f bottom = handle.b + (handle.radius - settings.stylus_depth) * up;
    const auto shape = [&](const Vec3f& p) {
        const float solid = std::min({capsule(p, Vec3f::Zero(), handle.b, handle.radius, handle.radius),
                                      capsule(p, proximal.a, proximal.b, proximal.radius, proximal.radius),
                                      capsule(p, distal.a, distal.b, proximal.radius, distal.radius),
                                      capsule(p, distal.b - 2.0f * distal.radius * Vec3f::UnitZ(), ball,
                                              distal.radius, tip_ball_radius)});
        // Rounding the whole tip would make it longer than the model.
        const float beyond = p.z() - scope.blade_length;
        return std::max({solid, beyond, -cylinder(p, bottom, top, bore)});
    };
    const float r = handle.radius;
    return surface_of(shape, {-r, -r, -r}, {r, handle.b.y() + r, scope.blade_length}, settings.spacing);
}

TriangleMesh tube_connector_part(const Tube& tube, const PartSettings& settings) {
    const float bore = 0.5f * tube.outer_diameter + settings.clearance;
    const float sensor = 0.5f * settings.sensor_diameter + settings.clearance;
    const float apart = bore + settings.wall + sensor;
    const float length = settings.sensor_length + settings.wall;
    const Vec3f rear(0.0f, 0.0f, -0.5f * length), front(0.0f, 0.0f, 0.5f * length);
    // Away from the concave side, which faces the tongue.
    const Vec3f beside(0.0f, -apart, 0.0f);
    const Vec3f over = 1e-3f * Vec3f::UnitZ();
    const auto shape = [&](const Vec3f& p) {
        const float body = std::max(capsule(p, rear, front, bore + settings.wall, bore + settings.wall),
                                    std::abs(p.z()) - 0.5f * length);
        const float side = cylinder(p, rear + beside, front + beside, sensor + settings.wall);
        const float web =
            box(p, {-settings.wall, -apart, -0.5f * length}, {settings.wall, 0.0f, 0.5f * length});
        const float solid = std::min({body, side, web});
        return std::max(
            {solid, -cylinder(p, rear - over, front + over, bore),
             -cylinder(p, rear + beside - over, front + beside - settings.wall * Vec3f::UnitZ(), sensor)});
    };
    const float wide = std::max(bore, sensor) + settings.wall;
    return surface_of(shape, {-wide, -apart - sensor - settings.wall, -0.5f * length},
                      {wide, bore + settings.wall, 0.5f * length}, 0.5f * settings.spacing);
}

TriangleMesh board_part(std::span<const Eigen::Vector3d> points, const PartSettings& settings) {
    constexpr float margin = 6e-3f, base = 6e-3f;    // [m], about the points of a step; under the lowest
    std::map<float, std::pair<Vec3f, Vec3f>> steps;  // by height (y grows downwards)
    for (const Eigen::Vector3d& point : points) {
        const Vec3f p = point.cast<float>();
        auto [step, fresh] = steps.try_emplace(p.y(), p, p);
        step->second.first = step->second.first.cwiseMin(p);
        step->second.second = step->second.second.cwiseMax(p);
    }
    if (steps.empty()) {
        throw std::invalid_argument("a board requires points");
    }
    const float bottom = steps.rbegin()->first + base;
    Vec3f low = Vec3f::Constant(1.0f), high = Vec3f::Constant(-1.0f);
    for (auto& [height, extent] : steps) {
        extent.first -= Vec3f(margin, 0.0f, margin);
        extent.second += Vec3f(margin, 0.0f, margin);
        extent.second.y() = bottom;
        low = low.cwiseMin(extent.first);
        high = high.cwiseMax(extent.second);
    }
    const auto shape = [&](const Vec3f& p) {
        float solid = 1.0f;
        for (const auto& [height, extent] : steps) {
            solid = std::min(solid, box(p, extent.first, extent.second));
        }
        for (const Eigen::Vector3d& point : points) {
            solid = std::max(solid, tip_ball_radius - (p - point.cast<float>()).norm());
        }
        return solid;
    };
    return surface_of(shape, low, high, settings.spacing);
}

void write_stl(const TriangleMesh& mesh, const std::filesystem::path& file) {
    static_assert(std::endian::native == std::endian::little, "STL is little-endian");
    std::string bytes("NeoETI, millimetres");
    bytes.resize(80);  // the header
    const auto put = [&](const auto& value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    put(static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const Triangle& triangle : mesh.triangles) {
        std::array<Vec3f, 4> facet;
        for (std::size_t k = 0; k < 3; ++k) {
            facet[k + 1] = 1e3f * mesh.vertices[triangle[k]];
        }
        facet[0] = (facet[2] - facet[1]).cross(facet[3] - facet[1]).normalized();
        for (const Vec3f& v : facet) {
            put(std::array<float, 3>{v.x(), v.y(), v.z()});
        }
        put(std::uint16_t{0});
    }
    if (const std::string why = write_file_atomically(file, bytes); !why.empty()) {
        throw std::runtime_error(
            fmt::format("{}: cannot be written: {}; choose another folder with --out", file.string(), why));
    }
}

}  // namespace eti::devices
