// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/room/solid.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace eti::render {
namespace {

// A quad of four vertices, counter-clockwise seen from outside.
void add_quad(std::vector<Triangle>& triangles, const std::array<std::uint32_t, 4>& corner) {
    triangles.push_back({corner[0], corner[1], corner[2]});
    triangles.push_back({corner[0], corner[2], corner[3]});
}

// Turns triangles whose vertex normals point against them.
void orient(Solid& solid) {
    for (Triangle& t : solid.triangles) {
        const auto& a = solid.vertices[t[0]];
        const auto& b = solid.vertices[t[1]];
        const auto& c = solid.vertices[t[2]];
        const Vec3f face = (b.position - a.position).cross(c.position - a.position);
        if (face.dot(a.normal + b.normal + c.normal) < 0.0f) {
            std::swap(t[1], t[2]);
        }
    }
}

}  // namespace

void Solid::append(const Solid& part, const RigidTransform& pose) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (const view::LitVertex& vertex : part.vertices) {
        vertices.push_back({pose * vertex.position, pose.rotation * vertex.normal});
    }
    colours.insert(colours.end(), part.colours.begin(), part.colours.end());
    for (const Triangle& t : part.triangles) {
        triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
}

Solid rounded_box(const Vec3f& centre, const Vec3f& half, float radius, VertexColour colour) {
    Solid box;
    const auto vertex = [](std::uint32_t corner, std::uint32_t axis) { return 3 * corner + axis; };
    for (std::uint32_t corner = 0; corner < 8; ++corner) {
        const Vec3f sign((corner & 1) != 0 ? 1.0f : -1.0f, (corner & 2) != 0 ? 1.0f : -1.0f,
                         (corner & 4) != 0 ? 1.0f : -1.0f);
        for (int axis = 0; axis < 3; ++axis) {
            const Vec3f normal = sign[axis] * Vec3f::Unit(axis);
            const Vec3f inner = sign.cwiseProduct(half - Vec3f::Constant(radius));
            box.vertices.push_back({centre + inner + radius * normal, normal});
        }
        box.triangles.push_back({vertex(corner, 0), vertex(corner, 1), vertex(corner, 2)});
    }
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const std::uint32_t along = 1u << axis, aside = 1u << ((axis + 1) % 3), up = 1u << ((axis + 2) % 3);
        for (const std::uint32_t side : {0u, along}) {
            add_quad(box.triangles, {vertex(side, axis), vertex(side | aside, axis),
                                     vertex(side | aside | up, axis), vertex(side | up, axis)});
        }
        // The edges along this axis, between the faces of the other two.
        const std::uint32_t one = (axis + 1) % 3, other = (axis + 2) % 3;
        for (const std::uint32_t edge : {0u, aside, up, aside | up}) {
            add_quad(box.triangles, {vertex(edge, one), vertex(edge | along, one),
                                     vertex(edge | along, other), vertex(edge, other)});
        }
    }
    orient(box);
    box.colours.assign(box.vertices.size(), colour);
    return box;
}

Solid sweep(std::span<const Ring> path, std::uint32_t sides, VertexColour colour) {
    Solid solid;
    const std::size_t count = path.size();
    const auto tangent = [&](std::size_t k) {
        const Vec3f way = path[std::min(k + 1, count - 1)].centre - path[k > 0 ? k - 1 : 0].centre;
        return Vec3f(way.normalized());
    };
    Vec3f aside = tangent(0).unitOrthogonal();
    const auto add_ring = [&](std::size_t k, const Vec3f& along, float slope, const Vec3f* flat) {
        const Vec3f up = along.cross(aside);
        for (std::uint32_t side = 0; side < sides; ++side) {
            const float turn =
                2.0f * std::numbers::pi_v<float> * static_cast<float>(side) / static_cast<float>(sides);
            const Vec3f out = std::cos(turn) * aside + std::sin(turn) * up;
            solid.vertices.push_back({path[k].centre + path[k].radius * out,
                                      flat != nullptr ? *flat : Vec3f((out - slope * along).normalized())});
        }
    };
    const auto add_end = [&](std::uint32_t ring, const Vec3f& centre, const Vec3f& out) {
        const auto middle = static_cast<std::uint32_t>(solid.vertices.size());
        solid.vertices.push_back({centre, out});
        for (std::uint32_t side = 0; side < sides; ++side) {
            solid.triangles.push_back({middle, ring + side, ring + (side + 1) % sides});
        }
    };
    const Vec3f back = -tangent(0), ahead = tangent(count - 1);
    add_ring(0, tangent(0), 0.0f, &back);
    add_end(0, path[0].centre, back);
    for (std::size_t k = 0; k < count; ++k) {
        const Vec3f along = tangent(k);
        aside = (aside - aside.dot(along) * along).normalized();
        const Ring& before = path[k > 0 ? k - 1 : 0];
        const Ring& after = path[std::min(k + 1, count - 1)];
        const float slope = (after.radius - before.radius) / (after.centre - before.centre).norm();
        const auto here = static_cast<std::uint32_t>(solid.vertices.size());
        add_ring(k, along, slope, nullptr);
        for (std::uint32_t side = 0; k > 0 && side < sides; ++side) {
            const std::uint32_t next = (side + 1) % sides;
            add_quad(solid.triangles, {here - sides + side, here - sides + next, here + next, here + side});
        }
    }
    const auto last = static_cast<std::uint32_t>(solid.vertices.size());
    add_ring(count - 1, ahead, 0.0f, &ahead);
    add_end(last, path[count - 1].centre, ahead);
    orient(solid);
    solid.colours.assign(solid.vertices.size(), colour);
    return solid;
}

std::vector<Vec3f> spline(std::span<const Vec3f> through, int steps) {
    std::vector<Vec3f> points;
    const std::size_t last = through.size() - 1;
    for (std::size_t k = 0; k < last; ++k) {
        const Vec3f &b = through[k], &c = through[k + 1];
        const Vec3f &a = through[k > 0 ? k - 1 : 0], &d = through[std::min(k + 2, last)];
        for (int step = 0; step < steps; ++step) {
            const float t = static_cast<float>(step) / static_cast<float>(steps);
            points.emplace_back(0.5f *
                                (2.0f * b + t * (c - a) + t * t * (2.0f * a - 5.0f * b + 4.0f * c - d) +
                                 t * t * t * (3.0f * b - a - 3.0f * c + d)));
        }
    }
    points.push_back(through[last]);
    return points;
}

Solid hose(std::span<const Vec3f> through, float radius, VertexColour colour) {
    std::vector<Ring> path;
    for (const Vec3f& point : spline(through, 6)) {
        path.push_back({point, radius});
    }
    return sweep(path, 10, colour);
}

}  // namespace eti::render
