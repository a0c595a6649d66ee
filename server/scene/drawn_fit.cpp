// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/drawn_fit.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "common/mesh/point_grid.hpp"

namespace eti::scene {

namespace {

// Of so many vertices one is asked: those between them are carried by the same frames.
constexpr std::size_t every = 3;
// Each halves about what is lacking; more of them draw kinks that the mesh does not have.
constexpr int rounds = 3;
// A vertex may lie outside its tetrahedron by so much of the tetrahedron's height: the drawn surface is
// smooth where the mesh's has corners. Farther outside, one that is drawn out says too much.
constexpr float outside = 0.5f;

/// Shares of a tetrahedron's corners in `point`: affine, negative beyond the face before a corner.
std::optional<std::array<float, 4>> shares_of(const Vec3f& point, const std::array<Vec3f, 4>& corner) {
    Mat3f edges;
    edges << corner[1] - corner[0], corner[2] - corner[0], corner[3] - corner[0];
    if (std::abs(edges.determinant()) < std::numeric_limits<float>::min()) {
        return std::nullopt;
    }
    const Vec3f u = edges.inverse() * (point - corner[0]);
    return std::array{1.0f - u.sum(), u.x(), u.y(), u.z()};
}

}  // namespace

void DrawnFit::configure(const anatomy::Patient& patient, std::span<const std::uint32_t> tetrahedra) {
    *this = {};
    rest_centre_ = patient.frame_rest_centre;
    maps_.resize(rest_centre_.size());
    lacks_.resize(rest_centre_.size());
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
    std::vector<bool> tongues(rest_centre_.size(), false), used(rest_centre_.size(), false);
    for (std::size_t c = 0; c < patient.clusters.size(); ++c) {
        tongues[anatomy::bone_count + c] = patient.clusters.tissue[c] == Tissue::tongue;
    }
    for (const Surface& surface : patient.surfaces) {
        for (std::size_t v = 0; surface.tissue == Tissue::tongue && v < surface.skin.size(); v += every) {
            Anchor anchor;
            anchor.point = {surface.mesh.vertices[v], surface.skin[v]};
            float innermost = -outside;
            bool found = false;
            grid.within(anchor.point.rest, 2.0f * reach, [&](std::uint32_t n, float) {
                const auto& corner = patient.tetrahedra.corners[tetrahedra[n]];
                std::array<Vec3f, 4> at;
                std::ranges::transform(corner, at.begin(),
                                       [&](std::uint32_t i) { return patient.particles.rest[i]; });
                const auto share = shares_of(anchor.point.rest, at);
                if (share && *std::ranges::min_element(*share) > innermost) {
                    innermost = *std::ranges::min_element(*share);
                    anchor.corner = corner;
                    anchor.share = *share;
                    found = true;
                }
            });
            if (!found) {
                continue;
            }
            anchors_.push_back(anchor);
            for (std::size_t k = 0; k < frames_per_point; ++k) {
                if (anchor.point.skin.weight[k] > 0.0f) {
                    used[anchor.point.skin.frame[k]] = true;
                }
            }
        }
    }
    for (std::size_t f = 0; f < used.size(); ++f) {
        if (used[f]) {
            used_.push_back(static_cast<std::uint16_t>(f));
            if (tongues[f]) {
                shifted_.push_back(static_cast<std::uint16_t>(f));
            }
        }
    }
}

void DrawnFit::shift(std::span<const Vec3f> position, std::span<FramePose> frames) {
    for (int round = 0; round < rounds; ++round) {
        for (const std::uint16_t f : used_) {
            maps_[f] = frame_map(frames[f], rest_centre_[f]);
            lacks_[f] = {};
        }
        for (const Anchor& anchor : anchors_) {
            Vec3f lack = -skin_point(anchor.point.rest, anchor.point.skin, maps_);
            for (std::size_t k = 0; k < anchor.corner.size(); ++k) {
                lack += anchor.share[k] * position[anchor.corner[k]];
            }
            const SkinWeights& skin = anchor.point.skin;
            for (std::size_t k = 0; k < frames_per_point; ++k) {
                lacks_[skin.frame[k]].sum += skin.weight[k] * lack;
                lacks_[skin.frame[k]].weight += skin.weight[k];
            }
        }
        for (const std::uint16_t f : shifted_) {
            frames[f].centre += lacks_[f].sum / lacks_[f].weight;
        }
    }
}

}  // namespace eti::scene
