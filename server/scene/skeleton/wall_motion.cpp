// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/skeleton/wall_motion.hpp"

#include <algorithm>
#include <cmath>

namespace eti::scene {

namespace {

using Carrier = YieldingSkeleton::Carrier;

constexpr float lattice_spacing = 5e-3f;  // [m]
constexpr float still = 1e-6f;            // [m]: a displacement below this counts as none

}  // namespace

WallMotion::WallMotion(std::span<const Vec3f> posed, std::span<const Carrier> carriers,
                       const YieldingSkeleton& skeleton)
    : reference_(skeleton.offset()), at_(reference_) {
    for (std::size_t b = 0; b < patient::bone_count; ++b) {
        from_reference_[b] = skeleton.bones()[b].inverse();
    }
    Vec3f low = posed.front();
    Vec3f high = low;
    for (const Vec3f& vertex : posed) {
        low = low.cwiseMin(vertex);
        high = high.cwiseMax(vertex);
    }
    // Two nodes of room on every side.
    origin_ = low - Vec3f::Constant(2.0f * lattice_spacing);
    for (int k = 0; k < 3; ++k) {
        size_[static_cast<std::size_t>(k)] =
            static_cast<std::size_t>(std::ceil((high[k] - low[k]) / lattice_spacing)) + 6;
    }
    const std::size_t count = size_[0] * size_[1] * size_[2];
    displacement_.assign(count, Vec3f::Zero());
    std::vector<float> weights(count, 0.0f);  // 0 far from all walls
    carrier_.assign(count, {});
    // Each vertex counts for the nodes around it, the more the nearer.
    for (std::size_t v = 0; v < posed.size(); ++v) {
        const Vec3f at = (posed[v] - origin_) / lattice_spacing;
        const auto near = [&](int k) { return static_cast<std::size_t>(std::floor(at[k])) - 1; };
        for (std::size_t z = near(2); z < near(2) + 4; ++z) {
            for (std::size_t y = near(1); y < near(1) + 4; ++y) {
                for (std::size_t x = near(0); x < near(0) + 4; ++x) {
                    const std::size_t n = (z * size_[1] + y) * size_[0] + x;
                    const Vec3f node(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
                    const float squared = (node - at).squaredNorm();
                    const float weight = 1.0f / ((0.05f + squared) * (0.05f + squared));
                    weights[n] += weight;
                    for (std::size_t b = 0; b < patient::bone_count; ++b) {
                        carrier_[n].bones[b] += weight * carriers[v].bones[b];
                    }
                    carrier_[n].hyoid += weight * carriers[v].hyoid;
                }
            }
        }
    }
    for (std::uint32_t n = 0; n < count; ++n) {
        if (weights[n] == 0.0f) {
            continue;
        }
        Carrier& carrier = carrier_[n];
        for (float& share : carrier.bones) {
            share /= weights[n];
        }
        carrier.hyoid /= weights[n];
        if (carrier.bones[0] < 1.0f || carrier.hyoid > 0.0f) {
            const std::size_t row = n / size_[0];
            nodes_.push_back({n, origin_ + lattice_spacing * Vec3f(static_cast<float>(n % size_[0]),
                                                                   static_cast<float>(row % size_[1]),
                                                                   static_cast<float>(row / size_[1]))});
        }
    }
}

void WallMotion::update(const YieldingSkeleton& skeleton) {
    patient::BonePoses since;
    for (std::size_t b = 0; b < patient::bone_count; ++b) {
        since[b] = skeleton.bones()[b] * from_reference_[b];
    }
    float farthest = 0.0f;
    float most = 0.0f;
    for (const auto& [n, at] : nodes_) {
        const Carrier& carrier = carrier_[n];
        Vec3f to = -at;
        for (std::size_t b = 0; b < patient::bone_count; ++b) {
            if (carrier.bones[b] > 0.0f) {
                to += carrier.bones[b] * (since[b] * at);
            }
        }
        if (carrier.hyoid > 0.0f) {
            to += carrier.hyoid * (skeleton.offset() - reference_).segment<3>(YieldingSkeleton::hyoid_left);
        }
        farthest = std::max(farthest, (to - displacement_[n]).squaredNorm());
        most = std::max(most, to.squaredNorm());
        displacement_[n] = to;
    }
    at_ = skeleton.offset();
    travel_ += std::sqrt(farthest);
    moved_ = most > still * still;
}

WallMotion::Place WallMotion::place_of(const Vec3f& point) const {
    Place place;
    std::array<std::size_t, 3> cell{};
    for (int k = 0; k < 3; ++k) {
        const auto n = static_cast<std::size_t>(k);
        const float last = static_cast<float>(size_[n] - 2);
        // In this order NaN becomes 0.
        const float at = std::min(std::max(0.0f, (point[k] - origin_[k]) / lattice_spacing), last);
        const float whole = std::min(std::floor(at), last - 1.0f);
        cell[n] = static_cast<std::size_t>(whole);
        place.share[k] = at - whole;
    }
    place.first = (cell[2] * size_[1] + cell[1]) * size_[0] + cell[0];
    return place;
}

template <class Body>
void WallMotion::for_nodes_around(const Vec3f& point, const Body& body) const {
    const Place p = place_of(point);
    for (std::size_t corner = 0; corner < 8; ++corner) {
        const std::size_t x = corner & 1;
        const std::size_t y = corner >> 1 & 1;
        const std::size_t z = corner >> 2;
        const float share = (x != 0 ? p.share.x() : 1.0f - p.share.x()) *
                            (y != 0 ? p.share.y() : 1.0f - p.share.y()) *
                            (z != 0 ? p.share.z() : 1.0f - p.share.z());
        body(p.first + x + size_[0] * (y + size_[1] * z), share);
    }
}

Vec3f WallMotion::displacement(const Vec3f& point) const {
    Vec3f sum = Vec3f::Zero();
    for_nodes_around(point, [&](std::size_t node, float share) { sum += share * displacement_[node]; });
    return sum;
}

Carrier WallMotion::carrier_at(const Vec3f& point) const {
    Carrier sum;
    for_nodes_around(point, [&](std::size_t node, float share) {
        for (std::size_t b = 0; b < patient::bone_count; ++b) {
            sum.bones[b] += share * carrier_[node].bones[b];
        }
        sum.hyoid += share * carrier_[node].hyoid;
    });
    return sum;
}

}  // namespace eti::scene
