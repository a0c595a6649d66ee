// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/metrics/occluders.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace eti::metrics {
namespace {

// [m]; points nearer than this to the eye plane have no useful image.
constexpr float near_plane = 1e-3f;

// Triangles per block: half as many double the bounds to test, twice as many double the triangles skinned for
// nothing.
constexpr std::size_t block_size = 16;

std::uint32_t spread_bits(std::uint32_t v) {
    v = (v | (v << 16)) & 0x030000ffu;
    v = (v | (v << 8)) & 0x0300f00fu;
    v = (v | (v << 4)) & 0x030c30c3u;
    return (v | (v << 2)) & 0x09249249u;
}

// Morton code (Z-order curve) on a grid of 1024 cells per axis.
std::uint32_t morton_code(const Vec3f& p, const Vec3f& low, float size) {
    std::uint32_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const float cell = std::clamp((p[axis] - low[axis]) / size * 1024.0f, 0.0f, 1023.0f);
        code |= spread_bits(static_cast<std::uint32_t>(cell)) << axis;
    }
    return code;
}

}  // namespace

SightLines::SightLines(const Vec3f& eye, std::span<const Vec3f> targets, float tolerance)
    : eye_(eye), blocked_(targets.size(), 0), open_(targets.size()) {
    Vec3f forward = Vec3f::Zero();
    for (const Vec3f& target : targets) {
        forward += target - eye;
    }
    forward = forward.norm() > 0.0f ? Vec3f(forward.normalized()) : Vec3f(Vec3f::UnitZ());
    const Vec3f side = forward.unitOrthogonal();
    to_eye_.row(0) = side.transpose();
    to_eye_.row(1) = forward.cross(side).transpose();
    to_eye_.row(2) = forward.transpose();

    for (std::size_t i = 0; i < targets.size(); ++i) {
        const Vec3f line = to_eye_frame(targets[i]);
        lines_.push_back(line);
        last_.push_back(1.0f - tolerance / std::max(line.norm(), tolerance));
        const float depth = std::max(line.z(), near_plane);
        image_.emplace_back(line.x() / depth, line.y() / depth);
        farthest_ = std::max(farthest_, line.z());
        if (line.z() <= near_plane) {  // beside or behind the eye: never visible
            blocked_[i] = 1;
            --open_;
        }
    }
    restrict_to_open_lines();
}

void SightLines::restrict_to_open_lines() {
    low_.setConstant(1e9f);
    high_.setConstant(-1e9f);
    tested_.resize(3, static_cast<Eigen::Index>(open_));
    Eigen::Index tested = 0;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        if (blocked_[i] == 0) {
            low_ = low_.cwiseMin(image_[i]);
            high_ = high_.cwiseMax(image_[i]);
            tested_.col(tested++) = lines_[i].normalized();
        }
    }
}

bool SightLines::may_meet_line(const Vec3f& centre, float radius) const {
    // Room for rounding, and for triangles that reach a little beyond their edges (block_by_triangle).
    constexpr float room = 1e-5f;  // [m]
    if (tested_.cols() == 0) {
        return false;
    }
    const float along = (centre.transpose() * tested_).array().square().maxCoeff();  // the greatest, squared
    const float squared = centre.squaredNorm();
    return squared - along <= (radius + room) * (radius + room) + 1e-6f * squared;
}

bool SightLines::may_meet_cone(const Vec3f& centre, float radius) const {
    if (centre.z() - radius > farthest_ || centre.z() + radius < 0.0f) {
        return false;
    }
    const Eigen::Vector2f middle = 0.5f * (low_ + high_);
    const float half = 0.5f * (high_ - low_).norm();
    const Eigen::Vector2f aside = centre.head<2>() - centre.z() * middle;
    return aside.norm() <= half * (centre.z() + radius) + radius * (1.0f + middle.norm());
}

void SightLines::block_by_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const float nearest = std::min({a.z(), b.z(), c.z()});
    if (nearest > farthest_ || std::max({a.z(), b.z(), c.z()}) < 0.0f) {
        return;
    }
    Eigen::Vector2f low = low_;
    Eigen::Vector2f high = high_;
    if (nearest > near_plane) {
        const Eigen::Vector2f pa = a.head<2>() / a.z();
        const Eigen::Vector2f pb = b.head<2>() / b.z();
        const Eigen::Vector2f pc = c.head<2>() / c.z();
        low = pa.cwiseMin(pb).cwiseMin(pc);
        high = pa.cwiseMax(pb).cwiseMax(pc);
        if ((low.array() > high_.array()).any() || (high.array() < low_.array()).any()) {
            return;
        }
    }
    // Möller & Trumbore 1997, with the ray's origin at zero. The slack closes cracks between neighbours that
    // are due to rounding.
    constexpr float slack = 1e-5f;
    const Vec3f ab = b - a;
    const Vec3f ac = c - a;
    const Vec3f q = ab.cross(a);
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        if (blocked_[i] != 0 || (image_[i].array() < low.array()).any() ||
            (image_[i].array() > high.array()).any()) {
            continue;
        }
        const Vec3f p = lines_[i].cross(ac);
        const float determinant = ab.dot(p);
        if (determinant == 0.0f) {
            continue;
        }
        const float u = -a.dot(p) / determinant;
        const float v = lines_[i].dot(q) / determinant;
        const float t = ac.dot(q) / determinant;
        if (u >= -slack && v >= -slack && u + v <= 1.0f + slack && t * lines_[i].z() > level_ &&
            t < last_[i]) {
            blocked_[i] = 1;
            --open_;
        }
    }
}

void SightLines::block_by_capsule(const Vec3f& a, const Vec3f& b, float radius) {
    if (!may_meet(0.5f * (a + b), 0.5f * (b - a).norm() + radius)) {
        return;
    }
    const Vec3f along = b - a;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        if (blocked_[i] != 0) {
            continue;
        }
        // Closest points of two segments (Ericson 2005, sec. 5.1.9); the line starts at zero.
        const Vec3f line = last_[i] * lines_[i];
        const float aa = line.squaredNorm();
        const float bb = along.squaredNorm();
        const float ab = line.dot(along);
        const float c = line.dot(a);
        const float denominator = aa * bb - ab * ab;
        float s = denominator > 1e-7f * aa * bb
                      ? std::clamp((c * bb - ab * along.dot(a)) / denominator, 0.0f, 1.0f)
                      : 0.0f;
        const float t = bb > 0.0f ? std::clamp((ab * s - along.dot(a)) / bb, 0.0f, 1.0f) : 0.0f;
        s = std::clamp((c + ab * t) / aa, 0.0f, 1.0f);
        if ((a + t * along - s * line).squaredNorm() < radius * radius) {
            blocked_[i] = 1;
            --open_;
        }
    }
}

void SightLines::block_by_cut_cylinder(const Vec3f& a, const Vec3f& b, float radius, const Vec3f& cut,
                                       float beyond) {
    if (!may_meet(0.5f * (a + b), 0.5f * (b - a).norm() + radius)) {
        return;
    }
    const Vec3f along = (b - a).normalized();
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        if (blocked_[i] != 0) {
            continue;
        }
        // The range of line parameters inside; the line starts at zero.
        float first = 0.0f, last = last_[i];
        const auto keep = [&](float slope, float limit) {  // clips to share * slope <= limit
            if (slope > 0.0f) {
                last = std::min(last, limit / slope);
            } else if (slope < 0.0f) {
                first = std::max(first, limit / slope);
            } else if (limit < 0.0f) {
                last = -1.0f;
            }
        };
        keep(-lines_[i].dot(along), -a.dot(along));
        keep(lines_[i].dot(cut), b.dot(cut) + beyond);
        // In the plane normal to the axis.
        const Vec3f across = lines_[i] - lines_[i].dot(along) * along, axis = a - a.dot(along) * along;
        const float nearest = across.squaredNorm() > 0.0f ? across.dot(axis) / across.squaredNorm() : 0.0f;
        const float inside = radius * radius - (axis - nearest * across).squaredNorm();
        if (inside <= 0.0f) {
            continue;
        }
        if (across.squaredNorm() > 0.0f) {
            const float half = std::sqrt(inside / across.squaredNorm());
            first = std::max(first, nearest - half);
            last = std::min(last, nearest + half);
        }
        if (first < last) {
            blocked_[i] = 1;
            --open_;
        }
    }
}

Occluder::Occluder(const TriangleMesh& mesh, std::span<const SkinWeights> skin)
    : rest_(mesh.vertices),
      skin_(skin.begin(), skin.end()),
      skinned_(mesh.vertices.size(), Vec3f::Zero()),
      skinned_in_(mesh.vertices.size(), 0),
      seen_(mesh.vertices.size(), Vec3f::Zero()),
      seen_in_(mesh.vertices.size(), 0) {
    if (mesh.triangles.empty()) {
        return;
    }
    Vec3f low = rest_[0];
    Vec3f high = rest_[0];
    for (const Vec3f& p : rest_) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const float size = std::max((high - low).maxCoeff(), 1e-6f);
    std::vector<std::uint32_t> code;
    for (const Triangle& t : mesh.triangles) {
        code.push_back(morton_code((rest_[t[0]] + rest_[t[1]] + rest_[t[2]]) / 3.0f, low, size));
    }
    std::vector<std::size_t> order(mesh.triangles.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return code[a] < code[b]; });
    // Vertices in the order of the triangles that use them.
    constexpr std::uint32_t unused = ~0u;
    std::vector<std::uint32_t> renumbered(rest_.size(), unused);
    std::uint32_t count = 0;
    for (const std::size_t index : order) {
        Triangle& triangle = triangles_.emplace_back(mesh.triangles[index]);
        for (std::uint32_t& vertex : triangle) {
            if (renumbered[vertex] == unused) {
                rest_[count] = mesh.vertices[vertex];
                skin_[count] = skin[vertex];
                renumbered[vertex] = count++;
            }
            vertex = renumbered[vertex];
        }
    }
    for (std::size_t first = 0; first < triangles_.size(); first += block_size) {
        add_block(first, std::min(first + block_size, triangles_.size()));
    }
}

void Occluder::add_block(std::size_t first, std::size_t end) {
    Block& block = blocks_.emplace_back();
    block.first_triangle = static_cast<std::uint32_t>(first);
    block.end_triangle = static_cast<std::uint32_t>(end);
    block.first_frame = static_cast<std::uint32_t>(frames_.size());
    std::vector<std::uint32_t> vertices;
    for (const Triangle& t : std::span(triangles_).subspan(first, end - first)) {
        vertices.insert(vertices.end(), t.begin(), t.end());
    }
    std::ranges::sort(vertices);
    const auto repeated = std::ranges::unique(vertices);
    vertices.erase(repeated.begin(), repeated.end());
    Vec3f low = rest_[vertices[0]];
    Vec3f high = low;
    std::map<std::uint16_t, float> mean;
    for (const std::uint32_t vertex : vertices) {
        low = low.cwiseMin(rest_[vertex]);
        high = high.cwiseMax(rest_[vertex]);
        for (std::size_t k = 0; k < frames_per_point; ++k) {
            if (skin_[vertex].weight[k] > 0.0f) {
                mean[skin_[vertex].frame[k]] += skin_[vertex].weight[k] / static_cast<float>(vertices.size());
            }
        }
    }
    for (const auto& [frame, weight] : mean) {
        frames_.push_back({frame, weight});
    }
    block.end_frame = static_cast<std::uint32_t>(frames_.size());
    block.centre = 0.5f * (low + high);
    for (const std::uint32_t vertex : vertices) {
        block.radius = std::max(block.radius, (rest_[vertex] - block.centre).norm());
        std::map<std::uint16_t, float> difference = mean;
        for (std::size_t k = 0; k < frames_per_point; ++k) {
            difference[skin_[vertex].frame[k]] -= skin_[vertex].weight[k];
        }
        float unlike = 0.0f;
        for (const auto& [frame, weight] : difference) {
            unlike += 0.5f * std::fabs(weight);
        }
        block.unlike = std::max(block.unlike, unlike);
    }
}

void Occluder::block_by_recent(SightLines& lines, const DeformedState& posture, RecentBlocks& recent) {
    ++call_;
    std::erase_if(recent, [&](std::uint32_t index) { return !block_by(blocks_[index], lines, posture); });
}

void Occluder::block(SightLines& lines, const DeformedState& posture, RecentBlocks& recent) {
    ++call_;
    for (std::uint32_t index = 0; index < blocks_.size() && !lines.all_blocked(); ++index) {
        if (block_by(blocks_[index], lines, posture)) {
            recent.push_back(index);
        }
    }
}

bool Occluder::may_meet(const SightLines& lines, const DeformedState& posture, const Vec3f& centre,
                        float radius) {
    if (posture.pressed) {
        radius += posture.pressed->reach(centre, radius);
    }
    if (posture.lips != nullptr && posture.lips->moves(centre, radius)) {
        radius += posture.lips->reach();
    }
    return lines.may_meet(lines.to_eye_frame(centre), radius);
}

bool Occluder::may_hide(const Block& block, const SightLines& lines, const DeformedState& posture) const {
    Eigen::Vector4f low = Eigen::Vector4f::Constant(1e9f);
    Eigen::Vector4f high = Eigen::Vector4f::Constant(-1e9f);
    Eigen::Vector4f centre = Eigen::Vector4f::Zero();
    for (std::uint32_t k = block.first_frame; k < block.end_frame; ++k) {
        const Eigen::Vector4f image = posture.frames[frames_[k].frame] * block.centre;
        low = low.cwiseMin(image);
        high = high.cwiseMax(image);
        centre += frames_[k].weight * image;
    }
    return may_meet(lines, posture, centre.head<3>(), block.radius + block.unlike * (high - low).norm());
}

const Vec3f& Occluder::skinned(std::uint32_t vertex, const DeformedState& posture) {
    if (skinned_in_[vertex] != deformation_) {
        skinned_in_[vertex] = deformation_;
        const SkinWeights& skin = skin_[vertex];
        Eigen::Vector4f sum = Eigen::Vector4f::Zero();
        for (std::size_t k = 0; k < frames_per_point; ++k) {
            if (skin.weight[k] > 0.0f) {
                sum += skin.weight[k] * (posture.frames[skin.frame[k]] * rest_[vertex]);
            }
        }
        skinned_[vertex] = sum.head<3>();
    }
    return skinned_[vertex];
}

bool Occluder::block_by(const Block& block, SightLines& lines, const DeformedState& posture) {
    if (!may_hide(block, lines, posture)) {
        return false;
    }
    const std::span members(triangles_.begin() + block.first_triangle,
                            triangles_.begin() + block.end_triangle);
    Vec3f low = Vec3f::Constant(1e9f);
    Vec3f high = Vec3f::Constant(-1e9f);
    for (const Triangle& triangle : members) {
        for (const std::uint32_t vertex : triangle) {
            const Vec3f& place = skinned(vertex, posture);
            low = low.cwiseMin(place);
            high = high.cwiseMax(place);
        }
    }
    if (!may_meet(lines, posture, 0.5f * (low + high), 0.5f * (high - low).norm())) {
        return false;
    }
    const auto see = [&](std::uint32_t vertex) -> const Vec3f& {
        if (seen_in_[vertex] != call_) {
            seen_in_[vertex] = call_;
            Vec3f place = skinned_[vertex];
            if (posture.pressed) {
                place = (*posture.pressed)(place);
            }
            seen_[vertex] =
                lines.to_eye_frame(posture.lips != nullptr ? posture.lips->retract_lips(place) : place);
        }
        return seen_[vertex];
    };
    const std::size_t before = lines.open();
    for (const Triangle& triangle : members) {
        lines.block_by_triangle(see(triangle[0]), see(triangle[1]), see(triangle[2]));
    }
    return lines.open() < before;
}

}  // namespace eti::metrics
