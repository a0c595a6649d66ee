// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/mesh/check.hpp"

#include <algorithm>
#include <cstdio>

#include "common/mesh/intersect.hpp"

namespace eti {
namespace {

/// Disjoint sets with path halving.
class Sets {
  public:
    explicit Sets(std::size_t count) {
        parent_.reserve(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            parent_.push_back(i);
        }
    }

    std::uint32_t find(std::uint32_t i) {
        while (parent_[i] != i) {
            parent_[i] = parent_[parent_[i]];
            i = parent_[i];
        }
        return i;
    }

    void join(std::uint32_t i, std::uint32_t j) { parent_[find(i)] = find(j); }

  private:
    std::vector<std::uint32_t> parent_;
};

/// A directed triangle edge: `corner` is 3 * triangle + position of its first vertex.
struct Side {
    std::uint32_t low, high;
    std::uint32_t corner;
    bool forward;
};

std::vector<Side> sorted_sides(const TriangleMesh& mesh) {
    std::vector<Side> sides;
    sides.reserve(3 * mesh.triangles.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t a = mesh.triangles[t][k];
            const std::uint32_t b = mesh.triangles[t][(k + 1) % 3];
            sides.push_back({std::min(a, b), std::max(a, b), 3 * t + k, a < b});
        }
    }
    std::sort(sides.begin(), sides.end(),
              [](const Side& x, const Side& y) { return x.low != y.low ? x.low < y.low : x.high < y.high; });
    return sides;
}

void note_fault(MeshReport& report, const Vec3f& place) {
    if (!report.fault_at) {
        report.fault_at = place;
    }
}

void measure(const TriangleMesh& mesh, MeshReport& report) {
    for (const Triangle& t : mesh.triangles) {
        const Vec3d a = mesh.vertices[t[0]].cast<double>();
        const Vec3d b = mesh.vertices[t[1]].cast<double>();
        const Vec3d c = mesh.vertices[t[2]].cast<double>();
        const double area = 0.5 * (b - a).cross(c - a).norm();
        const double longest =
            std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
        report.area += area;
        report.volume += a.dot(b.cross(c)) / 6.0;
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || area <= 1e-6 * longest) {
            ++report.degenerate_triangles;
            note_fault(report, mesh.vertices[t[0]]);
        }
    }
}

/// Edges, fans and components. Corners of a vertex that share an edge belong to one fan.
void examine_topology(const TriangleMesh& mesh, MeshReport& report) {
    const std::vector<Side> sides = sorted_sides(mesh);
    Sets fans(3 * mesh.triangles.size());
    Sets parts(mesh.vertices.size());
    long edges = 0;
    const auto corner_at = [&](const Side& side, std::uint32_t vertex) {
        const std::uint32_t t = side.corner / 3;
        const std::uint32_t k = side.corner % 3;
        return 3 * t + (mesh.triangles[t][k] == vertex ? k : (k + 1) % 3);
    };
    for (std::size_t begin = 0; begin < sides.size();) {
        std::size_t end = begin;
        while (end < sides.size() && sides[end].low == sides[begin].low &&
               sides[end].high == sides[begin].high) {
            ++end;
        }
        const Side& first = sides[begin];
        parts.join(first.low, first.high);
        ++edges;
        if (end - begin == 1) {
            ++report.open_edges;
        } else if (end - begin > 2) {
            ++report.nonmanifold_edges;
        } else if (first.forward == sides[begin + 1].forward) {
            ++report.misoriented_edges;
        }
        if (end - begin != 2 || first.forward == sides[begin + 1].forward) {
            note_fault(report, mesh.vertices[first.low]);
        }
        for (std::size_t i = begin + 1; i < end; ++i) {
            fans.join(corner_at(first, first.low), corner_at(sides[i], first.low));
            fans.join(corner_at(first, first.high), corner_at(sides[i], first.high));
        }
        begin = end;
    }
    std::vector<std::uint32_t> fan_count(mesh.vertices.size(), 0);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t v = mesh.triangles[t][k];
            if (fans.find(3 * t + k) == 3 * t + k) {
                ++fan_count[v];
            }
        }
    }
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        report.vertices += fan_count[v] > 0 ? 1 : 0;
        report.components += fan_count[v] > 0 && parts.find(v) == v ? 1 : 0;
        if (fan_count[v] > 1) {
            ++report.pinched_vertices;
            note_fault(report, mesh.vertices[v]);
        }
    }
    report.euler_characteristic =
        static_cast<long>(report.vertices) - edges + static_cast<long>(mesh.triangles.size());
}

}  // namespace

std::string MeshReport::describe() const {
    std::array<char, 400> line{};
    std::snprintf(
        line.data(), line.size(),
        "%zu vertices, %zu triangles, %zu components, Euler characteristic %ld, open edges %zu, "
        "non-manifold edges %zu, misoriented edges %zu, pinched vertices %zu, degenerate triangles %zu, "
        "crossing pairs %zu, volume %.4g m^3, area %.4g m^2",
        vertices, triangles, components, euler_characteristic, open_edges, nonmanifold_edges,
        misoriented_edges, pinched_vertices, degenerate_triangles, self_intersections, volume, area);
    return line.data();
}

MeshReport check(const TriangleMesh& mesh) {
    MeshReport report;
    report.triangles = mesh.triangles.size();
    measure(mesh, report);
    examine_topology(mesh, report);
    const auto crossings = self_intersections(mesh);
    report.self_intersections = crossings.size();
    if (!crossings.empty()) {
        note_fault(report, mesh.vertices[mesh.triangles[crossings.front()[0]][0]]);
    }
    return report;
}

}  // namespace eti
