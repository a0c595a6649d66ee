// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/mesh/outline_tessellation.hpp"

#include <algorithm>
#include <cmath>

namespace eti::render {
namespace {

// In half picture heights: edges of up to 15 pixels of 1080 stay, longer ones get steps of 9. Splitting all
// edges of 10 pixels would add twice as many triangles, half of them only a few pixels large.
constexpr float stays = 15.0f / 540.0f, longest = 9.0f / 540.0f;
// An edge at least this long is split if one of its ends lies on the outline, a shorter one if both do: the
// curved outline deviates from its flat edges by a few pixels at most.
constexpr float far_reaching = 30.0f / 540.0f;
// [m] in front of the eye; nearer points are not projected.
constexpr float nearest = 0.2e-3f;

// Half the picture's height and width divided by the distance, from a matrix that rotates, translates and
// scales.
Eigen::Vector2f scale_of(const Eigen::Matrix4f& view_projection) {
    return {view_projection.block<1, 3>(0, 0).norm(), view_projection.block<1, 3>(1, 0).norm()};
}

}  // namespace

int code_of(float steps) {
    int code = 0;
    while (code + 1 < step_codes && static_cast<float>(steps_of(code)) < steps) {
        ++code;
    }
    return code;
}

std::uint32_t pack(const TessellatedInstance& face) {
    std::uint32_t word = face.triangle;
    for (std::size_t edge = 0; edge < 3; ++edge) {
        word |= static_cast<std::uint32_t>(code_of(face.steps[edge])) << (20 + 4 * edge);
    }
    return word;
}

Vec3f barycentric_at(const TessellatedFace& face, int i, int j) {
    const int grid = face.grid();
    // The edge's own nearest point, in integers: the GPU rounds alike.
    const auto gathered = [&](int along, int steps) { return (2 * along * steps + grid) / (2 * grid); };
    const auto share = [](int part, int steps) {
        return static_cast<float>(part) / static_cast<float>(steps);
    };
    if (j == 0) {
        const int at = gathered(i, face.steps[0]);
        return {share(face.steps[0] - at, face.steps[0]), share(at, face.steps[0]), 0.0f};
    }
    if (i + j == grid) {
        const int at = gathered(j, face.steps[1]);
        return {0.0f, share(face.steps[1] - at, face.steps[1]), share(at, face.steps[1])};
    }
    if (i == 0) {
        const int at = gathered(j, face.steps[2]);
        return {share(face.steps[2] - at, face.steps[2]), 0.0f, share(at, face.steps[2])};
    }
    return {share(grid - i - j, grid), share(i, grid), share(j, grid)};
}

std::vector<Triangle> grid_triangles(int grid, bool turned) {
    std::vector<Triangle> triangles;
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        triangles.push_back(turned ? Triangle{a, c, b} : Triangle{a, b, c});
    };
    std::uint32_t row = 0;
    for (int j = 0; j < grid; ++j) {
        const std::uint32_t next = row + static_cast<std::uint32_t>(grid - j + 1);
        for (int i = 0; i < grid - j; ++i) {
            const auto at = static_cast<std::uint32_t>(i);
            add(row + at, row + at + 1, next + at);
            if (i + 1 < grid - j) {
                add(row + at + 1, next + at + 1, next + at);
            }
        }
        row = next;
    }
    return triangles;
}

view::LitVertex curved_vertex(const std::array<view::LitVertex, 3>& corners, const Vec3f& shares) {
    const auto& [a, b, c] = corners;
    const Vec3f flat = shares.x() * a.position + shares.y() * b.position + shares.z() * c.position;
    const auto above = [&](const view::LitVertex& corner) -> Vec3f {
        return corner.normal * (flat - corner.position).dot(corner.normal);
    };
    Vec3f bend = -0.5f * (shares.x() * above(a) + shares.y() * above(b) + shares.z() * above(c));
    bend *= std::min(1.0f, max_bend / std::max(bend.norm(), 1e-12f));
    const Vec3f normal = shares.x() * a.normal + shares.y() * b.normal + shares.z() * c.normal;
    return {flat + bend, normal / std::max(normal.norm(), 1e-10f)};
}

OutlineTessellation::OutlineTessellation(std::span<const Triangle> triangles, std::size_t vertex_count)
    : triangles_(triangles.begin(), triangles.end()),
      triangles_at_(vertex_count, 0),
      seen_(vertex_count),
      face_of_(triangles.size(), -1) {
    for (const Triangle& t : triangles_) {
        for (const std::uint32_t v : t) {
            ++triangles_at_[v];
        }
    }
}

bool OutlineTessellation::may_be_long(float edge, float distance, const OutlineView& look) {
    // A blade stretches tongue and folds by up to this; distant edges beyond it stay unsplit.
    constexpr float stretch = 4.0f;
    return stretch * edge * scale_of(look.view_projection).y() > stays * distance;
}

void OutlineTessellation::clear() {
    for (const std::size_t t : chosen_) {
        face_of_[t] = -1;
    }
    chosen_.clear();
    faces_.clear();
}

void OutlineTessellation::choose(std::span<const TriangleBlocks::Range> near, const OutlineView& look,
                                 const Place& place) {
    clear();
    ++look_;
    const Eigen::Vector2f scale = scale_of(look.view_projection);
    // In half picture heights.
    const float wide = scale.y() / scale.x();
    border_ = {wide, 1.0f};
    scale_ = scale.y();
    for (const auto& [first, count] : near) {
        for (std::size_t t = first; t < first + count; ++t) {
            const Triangle& corners = triangles_[t];
            for (const std::uint32_t v : corners) {
                Seen& seen = seen_[v];
                if (seen.look != look_) {
                    seen = {.place = place(v), .look = look_};
                    const Eigen::Vector4f clip = look.view_projection * seen.place.homogeneous();
                    if (clip.w() > nearest) {
                        seen.at = {wide * clip.x() / clip.w(), clip.y() / clip.w(), clip.w()};
                    }
                }
                ++seen.triangles;
            }
            const Vec3f &a = seen_[corners[0]].place, &b = seen_[corners[1]].place,
                        &c = seen_[corners[2]].place;
            const bool faces = (b - a).cross(c - a).dot(look.eye - a) > 0.0f;
            for (const std::uint32_t v : corners) {
                (faces ? seen_[v].faces : seen_[v].back_facing) = true;
            }
        }
    }
    for (const auto& [first, count] : near) {
        for (std::size_t t = first; t < first + count; ++t) {
            TessellatedFace face{.corners = triangles_[t]};
            if (std::ranges::none_of(face.corners, [&](std::uint32_t v) { return outline_at(v); })) {
                continue;
            }
            // Each swap reverses the orientation.
            const auto sort = [&](std::size_t i, std::size_t j) {
                if (face.corners[i] > face.corners[j]) {
                    std::swap(face.corners[i], face.corners[j]);
                    face.turned ^= 1;
                }
            };
            sort(0, 1);
            sort(1, 2);
            sort(0, 1);
            const auto& [a, b, c] = face.corners;
            face.steps = {steps(a, b), steps(b, c), steps(a, c)};
            if (face.grid() > 1) {
                face_of_[t] = static_cast<std::int32_t>(faces_.size());
                chosen_.push_back(t);
                faces_.push_back(face);
            }
        }
    }
}

// A vertex with triangles outside the candidates does not count: both triangles of an edge must decide
// alike.
bool OutlineTessellation::outline_at(std::uint32_t vertex) const {
    const Seen& seen = seen_[vertex];
    return seen.faces && seen.back_facing && seen.triangles == triangles_at_[vertex];
}

std::uint8_t OutlineTessellation::steps(std::uint32_t a, std::uint32_t b) const {
    const bool at_a = outline_at(a), at_b = outline_at(b);
    if (!at_a && !at_b) {
        return 1;
    }
    const Eigen::Vector3f &p = seen_[a].at, &q = seen_[b].at;
    float length = (p - q).head<2>().norm();
    if (p.z() <= 0.0f || q.z() <= 0.0f) {
        // One end is behind the eye: uses the length at the other end's depth.
        const float depth = std::max(p.z(), q.z());
        if (depth <= 0.0f) {
            return 1;
        }
        length = scale_ * (seen_[a].place - seen_[b].place).norm() / depth;
    }
    for (int axis = 0; axis < 2 && p.z() > 0.0f && q.z() > 0.0f; ++axis) {
        if ((p[axis] > border_[axis] && q[axis] > border_[axis]) ||
            (p[axis] < -border_[axis] && q[axis] < -border_[axis])) {
            return 1;
        }
    }
    if (length <= stays || (length <= far_reaching && !(at_a && at_b))) {
        return 1;
    }
    return static_cast<std::uint8_t>(steps_of(code_of(length / longest)));
}

}  // namespace eti::render
