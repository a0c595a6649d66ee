// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/build/skinner.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/units.hpp"
#include "server/patient/newborn/shape.hpp"

namespace eti::patient {

namespace {

// In spacings of the bulk's particles. A longer reach tears less under a blade, and follows it less closely.
constexpr float kernel_reach = 2.2f;
// Maximum distance of a particle in front of the surface. Normals of neighbours differ: a sharp limit would
// tear.
constexpr float before_surface = 1.0f;
// In spacings of a cluster's own particles: about its radius.
constexpr float cluster_reach = 2.2f;
// Minimum weight of a cluster for its particles, including those at the edge of all their clusters.
constexpr float min_of_cluster = 0.3f;
// Fraction of the kernel sum of a half-space from which particles alone carry a point.
constexpr float enough = 0.5f;
// Gums follow bone up to the first distance, fading out over the second [model mm].
constexpr float gum_mucosa = 0.6f;
constexpr float gum_fade = 1.0f;

// Falls smoothly from one to zero at `radius`.
float bump(float squared_distance, float radius) {
    const float b = std::max(1.0f - squared_distance / (radius * radius), 0.0f);
    return b * b;
}

bool moves_with_bone(Tissue tissue) {
    return tissue == Tissue::skull || tissue == Tissue::mandible || tissue == Tissue::spine;
}

}  // namespace

void add_share(Shares& shares, std::size_t frame, float weight) {
    if (!(weight > 0.0f)) {
        return;
    }
    const auto same = std::ranges::find(shares, frame, &Share::frame);
    if (same == shares.end()) {
        shares.push_back({static_cast<std::uint16_t>(frame), weight});
    } else {
        same->weight += weight;
    }
}

SkinWeights heaviest(Shares shares) {
    std::ranges::sort(shares, [](const Share& a, const Share& b) {
        return a.weight != b.weight ? a.weight > b.weight : a.frame < b.frame;
    });
    SkinWeights skin;
    const std::size_t kept = std::min(skin.frame.size(), shares.size());
    const float left_out = shares.size() > kept ? shares[kept].weight : 0.0f;
    float total = 0.0f;
    for (std::size_t k = 0; k < kept; ++k) {
        skin.frame[k] = shares[k].frame;
        skin.weight[k] = shares[k].weight - left_out;
        total += skin.weight[k];
    }
    if (!(total > 0.0f)) {  // more frames of equal weight than can be kept
        std::fill_n(skin.weight.begin(), kept, 1.0f);
        total = static_cast<float>(kept);
    }
    for (float& w : skin.weight) {
        w /= total;
    }
    return skin;
}

/// Accumulates weights by frame.
class Skinner::Sums {
  public:
    explicit Sums(std::size_t frames) : of_frame_(frames, 0.0f) {}
    void add(std::size_t frame, float weight) {
        if (weight > 0.0f) {
            if (of_frame_[frame] == 0.0f) {
                used_.push_back(static_cast<std::uint16_t>(frame));
            }
            of_frame_[frame] += weight;
            total_ += weight;
        }
    }
    [[nodiscard]] float total() const { return total_; }
    /// Weights of the frames as fractions of `whole`.
    [[nodiscard]] Shares of(float whole) const {
        Shares shares;
        for (const std::uint16_t f : used_) {
            shares.push_back({f, whole * of_frame_[f] / total_});
        }
        return shares;
    }

  private:
    std::vector<float> of_frame_;
    std::vector<std::uint16_t> used_;
    float total_ = 0.0f;
};

Skinner::Skinner(const Anatomy& anatomy, const BuildSettings& settings, const Patient& patient)
    : anatomy_(anatomy), patient_(patient), spacing_(settings.spacing * anatomy.scale() / millimetre) {
    const ParticleSet& set = patient.particles;
    const ClusterSet& clusters = patient.clusters;
    for (std::uint32_t i = 0; i < set.size(); ++i) {
        Family& family = families_[static_cast<std::size_t>(family_of(set.tissue[i]))];
        family.particles.push_back(i);
        family.rest.push_back(set.rest[i]);
    }
    for (const Family& family : families_) {
        grids_.emplace_back(family.rest, kernel_reach * spacing_);
    }
    // The epiglottis moves with its own clusters only: clusters of the body that contain its stalk would drag
    // the whole plate along (Xiao et al. 2020, Fig. 5).
    std::vector<std::vector<std::uint16_t>> clusters_of(set.size());
    for (std::uint32_t c = 0; c < clusters.size(); ++c) {
        float spacing = 0.0f;
        for (const std::uint32_t i : clusters.members(c)) {
            spacing = std::max(spacing, 2.0f * set.radius[i]);
            if (family_of(clusters.tissue[c]) == family_of(set.tissue[i])) {
                clusters_of[i].push_back(static_cast<std::uint16_t>(c));
            }
        }
        cluster_reach_.push_back(cluster_reach * spacing);
    }
    for (const auto& of_particle : clusters_of) {
        first_cluster_.push_back(static_cast<std::uint32_t>(cluster_of_.size()));
        cluster_of_.insert(cluster_of_.end(), of_particle.begin(), of_particle.end());
    }
    first_cluster_.push_back(static_cast<std::uint32_t>(cluster_of_.size()));
}

void Skinner::count(std::uint32_t particle, const Vec3f& point, float kernel, Sums& sums) const {
    const ParticleSet& set = patient_.particles;
    if (set.mass[particle] == 0.0f && set.tissue[particle] != Tissue::epiglottis) {
        for (std::size_t b = 0; b < bone_count; ++b) {
            sums.add(b, kernel * set.bones[particle][b]);
        }
        return;
    }
    const auto nearness = [&](std::uint16_t c) {
        const Vec3f& centre = patient_.frame_rest_centre[bone_count + c];
        return min_of_cluster + bump((centre - point).squaredNorm(), cluster_reach_[c]);
    };
    float total = 0.0f;
    for (std::uint32_t k = first_cluster_[particle]; k < first_cluster_[particle + 1]; ++k) {
        total += nearness(cluster_of_[k]);
    }
    for (std::uint32_t k = first_cluster_[particle]; k < first_cluster_[particle + 1]; ++k) {
        sums.add(bone_count + cluster_of_[k], kernel * nearness(cluster_of_[k]) / total);
    }
}

Shares Skinner::by_tissue(const Vec3f& point, Tissue tissue, const Vec3f& normal) const {
    const ParticleSet& set = patient_.particles;
    const auto family = static_cast<std::size_t>(family_of(tissue));
    const float radius = kernel_reach * spacing_;
    // The plate is thin, with folds on both sides, and so are the folds and the soft palate: both faces move
    // together.
    const bool thin = tissue == Tissue::epiglottis || tissue == Tissue::larynx ||
                      tissue == Tissue::vocal_cord || tissue == Tissue::palate;
    const Vec3f outward = thin ? Vec3f(Vec3f::Zero()) : normal;
    Sums sums(patient_.frame_rest_centre.size());
    grids_[family].within(point, radius, [&](std::uint32_t k, float squared) {
        const std::uint32_t i = families_[family].particles[k];
        const float before = outward.dot(set.rest[i] - point) / spacing_;
        const float size = 2.0f * set.radius[i] / spacing_;
        count(i, point,
              bump(squared, radius) * size * size * size * (1.0f - smoothstep(0.0f, before_surface, before)),
              sums);
    });
    // The kernel's integral over half a ball, in particles: 2 pi (1/3 - 2/5 + 1/7) reach^3.
    constexpr float half_space = 0.479f * kernel_reach * kernel_reach * kernel_reach;
    const float whole = tissue == Tissue::epiglottis && sums.total() > 0.0f
                            ? 1.0f
                            : smoothstep(0.0f, enough * half_space, sums.total());
    return whole > 0.0f ? sums.of(whole) : Shares{};
}

Shares Skinner::by_bones(const Vec3f& point, Tissue tissue) const {
    const BoneWeights weights = anatomy_.bone_weights(point, tissue);
    Shares shares;
    for (std::size_t b = 0; b < bone_count; ++b) {
        add_share(shares, b, weights[b]);
    }
    return shares;
}

Shares Skinner::operator()(const Vec3f& point, Tissue tissue, const Vec3f& normal) const {
    if (moves_with_bone(tissue)) {
        return by_bones(point, tissue);
    }
    Shares shares = by_tissue(point, tissue, normal);
    float left = 1.0f;
    for (const Share& share : shares) {
        left -= share.weight;
    }
    if (left > 1e-5f) {
        for (const auto& [frame, weight] : by_bones(point, tissue)) {
            add_share(shares, frame, left * weight);
        }
    }
    if (family_of(tissue) != 0) {
        return shares;
    }
    const Fields fields = anatomy_.fields(point);
    const auto gum = [&](float distance) {
        return 1.0f - smoothstep(gum_mucosa, gum_mucosa + gum_fade, distance / anatomy_.scale());
    };
    const float upper = gum(fields.upper_gum);
    const float lower = gum(fields.lower_gum);
    const float both = std::max(upper + lower, 1.0f);
    for (Share& share : shares) {
        share.weight *= 1.0f - (upper + lower) / both;
    }
    add_share(shares, static_cast<std::size_t>(Bone::skull), upper / both);
    add_share(shares, static_cast<std::size_t>(Bone::mandible), lower / both);
    return shares;
}

}  // namespace eti::patient
