// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/render/surface_faults.hpp"

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "common/math/units.hpp"
#include "common/mesh/intersect.hpp"

namespace eti::bench {

namespace {

constexpr float gaze_turn = 10.0f * degree, gaze_shift = 0.5e-3f;

float either_way(Random& random, float most) {
    return most * (2.0f * random.uniform() - 1.0f);
}

Vec3f turned(const Vec3f& way, const Vec3f& up, Random& random) {
    const Vec3f across = way.cross(up).normalized();
    const Eigen::AngleAxisf up_down(either_way(random, gaze_turn), across);
    const Eigen::AngleAxisf sideways(either_way(random, gaze_turn), up);
    return sideways * (up_down * way);
}

/// Where an edge of `edges` passes through `face`.
std::optional<Vec3f> piercing(const std::vector<Vec3f>& vertices, const Triangle& edges,
                              const Triangle& face) {
    const Vec3f &a = vertices[face[0]], &b = vertices[face[1]], &c = vertices[face[2]];
    const Vec3f normal = (b - a).cross(c - a);
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3f &p = vertices[edges[k]], &q = vertices[edges[(k + 1) % 3]];
        if (crosses(p, q, a, b, c)) {
            const float before = normal.dot(p - a), after = normal.dot(q - a);
            return p + before / (before - after) * (q - p);
        }
    }
    return std::nullopt;
}

/// Winding number of the organs about a point: 0 in air (van Oosterom & Strackee 1983, IEEE Trans Biomed Eng
/// 30:125, for the solid angle of a triangle).
double winding_number(const MeshSet& shapes, const Vec3f& point) {
    double angle = 0.0;
    for (const SurfaceMesh& shape : shapes.organs) {
        if (shape.bone) {
            continue;
        }
        for (const Triangle& t : shape.triangles) {
            const Vec3d a = (shape.vertices[t[0]] - point).cast<double>(),
                        b = (shape.vertices[t[1]] - point).cast<double>(),
                        c = (shape.vertices[t[2]] - point).cast<double>();
            const double la = a.norm(), lb = b.norm(), lc = c.norm();
            angle += 2.0 * std::atan2(a.dot(b.cross(c)),
                                      la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
        }
    }
    return angle / (4.0 * std::numbers::pi);
}

}  // namespace

SurfaceFaults::SurfaceFaults(const MeshSet& shapes) {
    for (std::size_t o = 0; o < shapes.organs.size(); ++o) {
        const SurfaceMesh& shape = shapes.organs[o];
        if (shape.bone) {
            continue;
        }
        const auto organ = static_cast<std::int16_t>(o);
        std::map<std::array<std::uint32_t, 2>, int> of_edge;
        for (const Triangle& t : shape.triangles) {
            for (std::size_t k = 0; k < 3; ++k) {
                const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
                ++of_edge[{low, high}];
            }
        }
        for (const auto& [edge, count] : of_edge) {
            if (count != 2) {
                open_.push_back({0.5f * (shape.vertices[edge[0]] + shape.vertices[edge[1]]), organ});
            }
        }
        const TriangleMesh mesh{.vertices = shape.vertices, .triangles = shape.triangles};
        for (const auto& [one, other] : self_intersections(mesh)) {
            const Triangle &t = mesh.triangles[one], &u = mesh.triangles[other];
            auto place = piercing(mesh.vertices, t, u);
            if (!place) {
                place = piercing(mesh.vertices, u, t);
            }
            if (place) {
                crossed_.push_back({*place, organ});
            }
        }
    }
}

int SurfaceFaults::seen(const std::vector<Fault>& faults, const Raster& raster,
                        const render::Camera& camera) {
    constexpr float before = 0.1e-3f;  // [m]
    const Vec3f gaze = (camera.target - camera.eye).normalized();
    const float n = camera.near_plane, f = camera.far_plane;
    int count = 0;
    for (const Fault& fault : faults) {
        const Eigen::Vector4f clip = raster.view_projection() * fault.place.homogeneous();
        const Eigen::Vector3f at = clip.head<3>() / clip.w();
        if (clip.w() <= 0.0f || at.cwiseAbs().maxCoeff() >= 1.0f) {
            continue;
        }
        const int x = static_cast<int>(0.5f * (1.0f + at.x()) * static_cast<float>(raster.width()));
        const int y = static_cast<int>(0.5f * (1.0f - at.y()) * static_cast<float>(raster.height()));
        const Hit& hit = raster.at(x, y);
        const float distance = 2.0f * f * n / (f + n - (2.0f * hit.depth - 1.0f) * (f - n));
        count += hit.object == fault.organ && gaze.dot(fault.place - camera.eye) < distance + before ? 1 : 0;
    }
    return count;
}

SurfaceFaults::Count SurfaceFaults::in_view(const Raster& raster, const render::Camera& camera) const {
    return {seen(open_, raster, camera), seen(crossed_, raster, camera)};
}

render::Camera gaze_beside(const render::Camera& lens, Random& random) {
    render::Camera gaze = lens;
    const Vec3f way = turned(lens.target - lens.eye, lens.up, random);
    for (int axis = 0; axis < 3; ++axis) {
        gaze.eye[axis] += either_way(random, gaze_shift);
    }
    gaze.target = gaze.eye + way;
    return gaze;
}

render::Camera gaze_in_throat(const MeshSet& shapes, const Landmarks& landmarks, const render::Camera& lens,
                              Random& random) {
    constexpr float reach = 6e-3f;  // [m]
    constexpr int tries = 1000;
    render::Camera gaze = lens;
    const Vec3f& tip = at(landmarks, Landmark::epiglottis_tip);
    for (int i = 0; i < tries; ++i) {
        Vec3f off;
        for (int axis = 0; axis < 3; ++axis) {
            off[axis] = either_way(random, reach);
        }
        gaze.eye = tip + off;
        if (off.norm() < reach && std::abs(winding_number(shapes, gaze.eye)) < 0.5) {
            break;
        }
    }
    gaze.up = -Vec3f::UnitY();
    gaze.target = gaze.eye + turned(at(landmarks, Landmark::glottis) - gaze.eye, gaze.up, random);
    return gaze;
}

}  // namespace eti::bench
