// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/placement/head_sketch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/parallel/loops.hpp"
#include "server/patient/imaging/resample.hpp"
#include "server/patient/mesh/components.hpp"
#include "server/patient/newborn/newborn.hpp"
#include "server/patient/segmentation/segment.hpp"

namespace eti::segmentation {

namespace {

using imaging::Bits;
using imaging::Geometry;

/// Calls visit(neighbour) for the voxels that share a face with `i`.
template <class Visit>
void for_each_beside(const Geometry& g, std::size_t i, const Visit& visit) {
    const auto [x, y, z] = g.coordinates(i);
    for (const auto [dx, dy, dz] :
         {std::array{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}) {
        if (g.contains(x + dx, y + dy, z + dz)) {
            visit(g.index(x + dx, y + dy, z + dz));
        }
    }
}

/// Solid voxels adjacent to air around the head.
Bits skin_of(const Geometry& g, const Bits& body, const Bits& outside) {
    Bits skin(body.size(), 0);
    for (std::size_t i = 0; i < body.size(); ++i) {
        if (body[i] != 0) {
            for_each_beside(g, i, [&](std::size_t j) { skin[i] |= outside[j]; });
        }
    }
    return skin;
}

/// Computes distances and points from bits; at most about `most` points of a kind.
void finish(Sketch& sketch, std::size_t most) {
    for (std::size_t k = 0; k < sketch_kinds; ++k) {
        sketch.distance[k] = imaging::distance_to(sketch.geometry.size, sketch.bits[k]);
        std::vector<std::size_t> all;
        for (std::size_t i = 0; i < sketch.bits[k].size(); ++i) {
            sketch.distance[k][i] *= static_cast<float>(sketch.spacing());
            if (sketch.bits[k][i] != 0) {
                all.push_back(i);
            }
        }
        const std::size_t stride = std::max<std::size_t>(1, all.size() / most);
        for (std::size_t i = stride / 2; i < all.size(); i += stride) {
            const auto [x, y, z] = sketch.geometry.coordinates(all[i]);
            sketch.points[k].push_back(sketch.geometry.point(x, y, z));
        }
    }
}

/// The largest balls in soft tissue, each with its centre outside of the previous ones.
std::vector<Ball> soft_balls(const Sketch& sketch, std::size_t most) {
    const Geometry& g = sketch.geometry;
    Bits blocked(g.count());
    for (std::size_t i = 0; i < blocked.size(); ++i) {
        blocked[i] = sketch.solid[i] == 0 || sketch.bits[0][i] != 0 ? 1 : 0;
    }
    const std::vector<float> depth = imaging::distance_to(g.size, blocked);
    const auto room = [&](std::size_t i) {
        const auto [x, y, z] = g.coordinates(i);
        const auto side = static_cast<float>(
            1 + std::min({x, y, z, g.size[0] - 1 - x, g.size[1] - 1 - y, g.size[2] - 1 - z}));
        return std::min(depth[i], side);
    };
    std::vector<Ball> balls;
    while (balls.size() < most) {
        std::size_t best = 0;
        float largest = 0.0f;
        for (std::size_t i = 0; i < blocked.size(); ++i) {
            if (blocked[i] == 0 && room(i) > largest) {
                largest = room(i);
                best = i;
            }
        }
        if (largest < 4.0f) {
            break;
        }
        const auto [x, y, z] = g.coordinates(best);
        const Vec3d centre = g.point(x, y, z);
        const double radius = static_cast<double>(largest) * sketch.spacing();
        balls.push_back({centre, radius});
        for (std::size_t i = 0; i < blocked.size(); ++i) {
            const auto [a, b, c] = g.coordinates(i);
            if ((g.point(a, b, c) - centre).norm() < radius) {
                blocked[i] = 1;
            }
        }
    }
    return balls;
}

/// Fractions of directions around a ball: in which bone comes first, among those that the volume covers; and
/// those that it covers.
struct Shell {
    double bone = 0.0;
    double shown = 0.0;
};
Shell shell_around(const Sketch& sketch, const Ball& ball) {
    constexpr double farthest = 2.0;  // radii; a head is longer than wide
    int bone = 0;
    int other = 0;
    const std::vector<Vec3d> all = directions(400);
    for (const Vec3d& direction : all) {
        bool decided = false;
        for (double r = 0.0; r < farthest * ball.radius && !decided; r += 0.5 * sketch.spacing()) {
            const auto i = sketch.at(ball.centre + r * direction);
            if (!i || sketch.seen[*i] == 0) {
                decided = true;
            } else if (sketch.bits[0][*i] != 0) {
                ++bone;
                decided = true;
            } else if (sketch.solid[*i] == 0) {
                ++other;
                decided = true;
            }
        }
        other += decided ? 0 : 1;
    }
    return {static_cast<double>(bone) / std::max(1, bone + other),
            static_cast<double>(bone + other) / static_cast<double>(all.size())};
}

}  // namespace

double Sketch::across() const {
    const auto count = std::count(solid.begin(), solid.end(), std::uint8_t{1});
    return std::cbrt(static_cast<double>(count)) * spacing();
}

Sketch sketch_volume(const imaging::Volume& volume, const SegmentSettings& settings) {
    std::size_t tissue = 0;
    for (const float v : volume.value) {
        tissue += v >= settings.air_below ? 1 : 0;
    }
    const double edge = std::cbrt(static_cast<double>(tissue) * volume.geometry.voxel_volume());
    const imaging::Volume coarse = imaging::downsampled(volume, std::clamp(edge / 40.0, 1.5e-3, 6e-3));
    Sketch sketch;
    sketch.geometry = coarse.geometry;
    const Geometry& g = sketch.geometry;
    const std::size_t n = g.count();
    sketch.seen.assign(n, 0);
    Bits solid(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
        sketch.seen[i] = std::isnan(coarse.value[i]) ? 0 : 1;
        solid[i] = coarse.value[i] >= settings.air_below ? 1 : 0;
    }
    const Components bodies = components(g.size, solid);
    const std::uint32_t patient = bodies.largest();
    sketch.solid.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
        sketch.solid[i] = patient != 0 && bodies.part[i] == patient ? 1 : 0;
    }
    const auto radius = static_cast<float>(static_cast<double>(settings.closing) / sketch.spacing());
    const Bits body = imaging::morphological_close(g.size, sketch.solid, std::max(radius, 2.0f));
    Bits outside(n, 0);
    for (auto& b : sketch.bits) {
        b.assign(n, 0);
    }
    // A voxel partly filled by thin bone counts as bone here; soft tissue stays below 100 HU.
    const float bone_above = 0.66f * settings.bone_above;
    for (std::size_t i = 0; i < n; ++i) {
        outside[i] = sketch.seen[i] != 0 && body[i] == 0 ? 1 : 0;
        sketch.bits[0][i] = sketch.solid[i] != 0 && coarse.value[i] > bone_above ? 1 : 0;
        sketch.bits[1][i] = sketch.seen[i] != 0 && body[i] != 0 && solid[i] == 0 ? 1 : 0;
    }
    sketch.bits[2] = skin_of(g, body, outside);
    finish(sketch, 2500);
    return sketch;
}

std::optional<Ball> find_cranium(const Sketch& sketch) {
    constexpr double min_bone = 0.6;   // a newborn's fontanelles and foramen leave 0.95, a chest 0.1
    constexpr double min_shown = 0.3;  // of all directions
    std::optional<Ball> cranium;
    for (const Ball& ball : soft_balls(sketch, 6)) {
        const Shell shell = shell_around(sketch, ball);
        if (shell.bone >= min_bone && shell.shown >= min_shown &&
            (!cranium || ball.radius > cranium->radius)) {
            cranium = ball;
        }
    }
    return cranium;
}

std::vector<Vec3d> directions(int count) {
    std::vector<Vec3d> all;
    for (int i = 0; i < count; ++i) {
        const double z = 1.0 - (2.0 * i + 1.0) / count;
        const double turn = 2.0 * std::numbers::pi * i / std::numbers::phi;
        const double r = std::sqrt(1.0 - z * z);
        all.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
    }
    return all;
}

Vec3d mean_of(const std::vector<Vec3d>& points) {
    Vec3d sum = Vec3d::Zero();
    for (const Vec3d& p : points) {
        sum += p;
    }
    return points.empty() ? sum : Vec3d(sum / static_cast<double>(points.size()));
}

Atlas make_atlas(float head_scale) {
    NewbornShape shape;
    shape.head_scale = head_scale;
    const patient::Newborn newborn(shape);
    constexpr double spacing = 3e-3;
    constexpr int margin = 10;  // voxels of margin, so that there are distances outside, too
    const auto [low, high] = newborn.bounds();
    Atlas atlas;
    Geometry& g = atlas.sketch.geometry;
    g.step = spacing * Eigen::Matrix3d::Identity();
    g.origin = low.cast<double>() - Vec3d::Constant(margin * spacing);
    for (int k = 0; k < 3; ++k) {
        g.size[static_cast<std::size_t>(k)] =
            static_cast<int>(std::ceil(static_cast<double>(high[k] - low[k]) / spacing)) + 1 + 2 * margin;
    }
    const std::size_t n = g.count();
    Bits outside(n, 0);
    Bits body(n, 0);
    atlas.sketch.seen.assign(n, 0);
    atlas.sketch.solid.assign(n, 0);
    for (auto& b : atlas.sketch.bits) {
        b.assign(n, 0);
    }
    parallel::for_each(g.size[2], 1, [&](int z) {
        for (int y = 0; y < g.size[1]; ++y) {
            for (int x = 0; x < g.size[0]; ++x) {
                const std::size_t i = g.index(x, y, z);
                // Below the atlas's box there is an unknown trunk; around it there is air.
                atlas.sketch.seen[i] = z >= margin ? 1 : 0;
                outside[i] = atlas.sketch.seen[i];
                if (std::min({x, y, z}) < margin || x >= g.size[0] - margin || y >= g.size[1] - margin ||
                    z >= g.size[2] - margin) {
                    continue;
                }
                const patient::Fields f = newborn.fields(g.point(x, y, z).cast<float>());
                outside[i] = f.skin > 0.0f ? 1 : 0;
                body[i] = 1 - outside[i];
                const bool air = std::max({f.cavity, -f.tongue, -f.epiglottis}) < 0.0f;
                const float bone = std::min({f.skull, f.mandible, f.spine});
                atlas.sketch.solid[i] = body[i] != 0 && !air ? 1 : 0;
                // Thin plates count if they are within half a voxel.
                atlas.sketch.bits[0][i] = body[i] != 0 && bone < 0.25f * static_cast<float>(spacing) ? 1 : 0;
                atlas.sketch.bits[1][i] = body[i] != 0 && air ? 1 : 0;
            }
        }
    });
    atlas.sketch.bits[2] = skin_of(g, body, outside);
    finish(atlas.sketch, 1500);
    atlas.cranium = soft_balls(atlas.sketch, 1).front();
    atlas.airway = mean_of(atlas.sketch.points[1]);
    return atlas;
}

}  // namespace eti::segmentation
