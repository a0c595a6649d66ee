// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/mesh/point_grid.hpp"
#include "common/mesh/skinning.hpp"
#include "server/patient/newborn/anatomy.hpp"
#include "server/patient/newborn/build.hpp"

namespace eti::anatomy {

/// One frame's share of a point.
struct Share {
    std::uint16_t frame = 0;
    float weight = 0.0f;
};

/// All frames that carry a point, each once; their weights sum to one.
using Shares = std::vector<Share>;

/// Adds to a frame's share.
void add_share(Shares& shares, std::size_t frame, float weight);

/// The heaviest frames, as many as a point may have. What the first one left out weighs is taken from those
/// kept too: so a frame that is kept at one vertex and left out at its neighbour weighs next to nothing
/// there.
[[nodiscard]] SkinWeights heaviest(Shares shares);

/// Says which frames carry a point of the patient, and how much each: those of the particles around it, and
/// bones where there are few. All of it changes smoothly from place to place, so that what is skinned does
/// not tear between particles (docs/decisions/skinning.md).
class Skinner {
  public:
    Skinner(const Anatomy& anatomy, const BuildSettings& settings, const Patient& patient);

    /// `normal`: outward, of the surface that the point lies on; zero for a point that lies on none. What
    /// lies before a surface, across the air, does not carry it.
    [[nodiscard]] Shares operator()(const Vec3f& point, Tissue tissue,
                                    const Vec3f& normal = Vec3f::Zero()) const;

  private:
    class Sums;
    void count(std::uint32_t particle, const Vec3f& point, float kernel, Sums& sums) const;
    [[nodiscard]] Shares by_tissue(const Vec3f& point, Tissue tissue, const Vec3f& normal) const;
    [[nodiscard]] Shares by_bones(const Vec3f& point, Tissue tissue) const;

    const Anatomy& anatomy_;
    const Patient& patient_;
    float spacing_;  // [m], of the bulk's particles
    struct Family {
        std::vector<std::uint32_t> particles;
        std::vector<Vec3f> rest;
    };
    std::array<Family, 3> families_;
    std::vector<PointGrid> grids_;              // by family
    std::vector<std::uint32_t> first_cluster_;  // by particle, and one past the last
    std::vector<std::uint16_t> cluster_of_;     // of a particle those of its own family
    std::vector<float> cluster_reach_;          // [m]
};

}  // namespace eti::anatomy
