// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/mesh/point_grid.hpp"
#include "common/mesh/skinning.hpp"
#include "server/patient/newborn/anatomy.hpp"
#include "server/patient/newborn/build/build.hpp"

namespace eti::patient {

/// Skinning weight of one frame.
struct Share {
    std::uint16_t frame = 0;
    float weight = 0.0f;
};

/// All frames of a point, without duplicates; weights sum to one.
using Shares = std::vector<Share>;

/// Adds to a frame's weight.
void add_share(Shares& shares, std::size_t frame, float weight);

/// Truncates to the heaviest frames, up to the maximum per point. The weight of the first dropped frame is
/// subtracted from the kept ones, so that a frame kept at one vertex and dropped at its neighbour has almost
/// no weight there.
[[nodiscard]] SkinWeights heaviest(Shares shares);

/// Computes skinning weights of a point: frames of the particles around it, and bones where particles are
/// sparse. Weights are smooth in space, so that skinned surfaces do not tear between particles
/// (docs/decisions/skinning.md).
class Skinner {
  public:
    Skinner(const Anatomy& anatomy, const BuildSettings& settings, const Patient& patient);

    /// `normal`: outward normal of the surface that contains the point; zero if none. Particles in front of
    /// the surface, across air, have no weight.
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
    std::vector<PointGrid> grids_;              // [families]
    std::vector<std::uint32_t> first_cluster_;  // [particles + 1]
    std::vector<std::uint16_t> cluster_of_;     // clusters of a particle, of its own family
    std::vector<float> cluster_reach_;          // [m]
};

}  // namespace eti::patient
