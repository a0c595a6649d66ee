// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/skin_frame_correction.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "common/mesh/point_grid.hpp"

namespace eti::scene {

namespace {

// One in this many vertices is an anchor: vertices in between are carried by the same frames.
constexpr std::size_t every = 3;
// Each iteration halves the residual; more iterations draw kinks that the mesh does not have.
constexpr int rounds = 3;
// A vertex may lie outside its tetrahedron by this fraction of its height: the drawn surface is smooth where
// the mesh has corners. Farther outside, extrapolation from a stretched tetrahedron is unreliable.
constexpr float outside = 0.5f;

/// Barycentric coordinates of `point` in a tetrahedron; negative beyond the face opposite a corner.
std::optional<std::array<float, 4>> shares_of(const Vec3f& point, const std::array<Vec3f, 4>& corner) {
    Mat3f edges;
    edges << corner[1] - corner[0], corner[2] - corner[0], corner[3] - corner[0];
    if (std::abs(edges.determinant()) < std::numeric_limits<float>::min()) {
        return std::nullopt;
    }
    const Vec3f u = edges.inverse() * (point - corner[0]);
    return std::array{1.0f - u.sum(), u.x(), u.y(), u.z()};
}

Eigen::Vector4f wide(const Vec3f& v) {
    return {v.x(), v.y(), v.z(), 0.0f};
}

}  // namespace

void SkinFrameCorrection::configure(const patient::Patient& patient,
                                    std::span<const std::uint32_t> tetrahedra) {
    *this = {};
    rest_centre_ = patient.frame_rest_centre;
    maps_.resize(rest_centre_.size());
    carried_.assign(rest_centre_.size(), 0.0f);
    sum_.assign(rest_centre_.size(), Eigen::Vector4f::Zero());
    way_ = sum_;
    std::vector<Vec3f> centre;
    float reach = 0.0f;  // [m], of the largest tetrahedron
    for (const std::uint32_t t : tetrahedra) {
        Vec3f& middle = centre.emplace_back(Vec3f::Zero());
        for (const std::uint32_t i : patient.tetrahedra.corners[t]) {
            middle += 0.25f * patient.particles.rest[i];
        }
        for (const std::uint32_t i : patient.tetrahedra.corners[t]) {
            reach = std::max(reach, (patient.particles.rest[i] - middle).norm());
        }
    }
    if (centre.empty()) {
        return;
    }
    const PointGrid grid(centre, reach);
    for (const Surface& surface : patient.surfaces) {
        for (std::size_t v = 0; surface.tissue == Tissue::tongue && v < surface.skin.size(); v += every) {
            const Vec3f& rest = surface.mesh.vertices[v];
            Anchor anchor{.rest = rest, .corner = {}, .share = {}};
            float innermost = -outside;
            bool found = false;
            grid.within(rest, 2.0f * reach, [&](std::uint32_t n, float) {
                const auto& corner = patient.tetrahedra.corners[tetrahedra[n]];
                std::array<Vec3f, 4> at;
                std::ranges::transform(corner, at.begin(),
                                       [&](std::uint32_t i) { return patient.particles.rest[i]; });
                const auto share = shares_of(rest, at);
                if (share && *std::ranges::min_element(*share) > innermost) {
                    innermost = *std::ranges::min_element(*share);
                    anchor.corner = corner;
                    anchor.share = *share;
                    found = true;
                }
            });
            if (found) {
                add(anchor, surface.skin[v]);
            }
        }
    }
    residual_.resize(anchors_.size());
    for (std::size_t f = 0; f < carried_.size(); ++f) {
        if (carried_[f] > 0.0f) {
            used_.push_back(static_cast<std::uint16_t>(f));
            const std::size_t cluster = f - patient::bone_count;
            if (f >= patient::bone_count && cluster < patient.clusters.size() &&
                patient.clusters.tissue[cluster] == Tissue::tongue) {
                shifted_.push_back(static_cast<std::uint16_t>(f));
            }
        }
    }
}

void SkinFrameCorrection::add(const Anchor& anchor, const SkinWeights& skin) {
    Anchor& added = anchors_.emplace_back(anchor);
    added.first = static_cast<std::uint32_t>(carriers_.size());
    for (std::size_t k = 0; k < frames_per_point; ++k) {
        if (skin.weight[k] > 0.0f) {
            carriers_.push_back({skin.frame[k], skin.weight[k]});
            carried_[skin.frame[k]] += skin.weight[k];
        }
    }
    added.end = static_cast<std::uint32_t>(carriers_.size());
}

void SkinFrameCorrection::shift(std::span<const Vec3f> position, std::span<FramePose> frames) {
    for (const std::uint16_t f : used_) {
        const FrameMap map = frame_map(frames[f], rest_centre_[f]);
        for (int column = 0; column < 3; ++column) {
            maps_[f][static_cast<std::size_t>(column)] = wide(map.linear.col(column));
        }
        maps_[f][3] = wide(map.offset);
    }
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t a = 0; a < anchors_.size(); ++a) {
            const Anchor& anchor = anchors_[a];
            const std::span<const Carrier> carriers(carriers_.data() + anchor.first,
                                                    carriers_.data() + anchor.end);
            Eigen::Vector4f& lack = residual_[a];
            if (round == 0) {
                Vec3f wanted = Vec3f::Zero();
                for (std::size_t k = 0; k < anchor.corner.size(); ++k) {
                    wanted += anchor.share[k] * position[anchor.corner[k]];
                }
                lack = wide(wanted);
                for (const Carrier& c : carriers) {
                    const Columns& map = maps_[c.frame];
                    lack -= c.weight * (map[0] * anchor.rest.x() + map[1] * anchor.rest.y() +
                                        map[2] * anchor.rest.z() + map[3]);
                }
            } else {
                for (const Carrier& c : carriers) {
                    lack -= c.weight * way_[c.frame];
                }
            }
            for (const Carrier& c : carriers) {
                sum_[c.frame] += c.weight * lack;
            }
        }
        for (const std::uint16_t f : shifted_) {
            way_[f] = sum_[f] / carried_[f];  // stays zero for all others
            frames[f].centre += Vec3f(way_[f].x(), way_[f].y(), way_[f].z());
        }
        for (const std::uint16_t f : used_) {
            sum_[f].setZero();
        }
    }
}

}  // namespace eti::scene
