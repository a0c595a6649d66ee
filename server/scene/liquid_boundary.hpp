// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/distance_grid.hpp"
#include "server/pbd/particles.hpp"

namespace eti::scene {

/// Boundary of the liquid: the offset shell, and in front of it the soft tissue's particles as balls. Both
/// are written into one distance grid on the shell's nodes, but only near liquid; elsewhere the grid keeps
/// older values. The liquid exerts no force on the tissue. Not thread safe: whoever computes the liquid's
/// step calls all functions.
class LiquidBoundary {
  public:
    /// `reach` [m]: distances are exact within this range of the tissue. `way` [m]: greatest travel of liquid
    /// between two updates for which the boundary stays valid.
    LiquidBoundary(float reach, float way) : reach_(reach), way_(way) {}

    /// Discards all tissue. Call it when shell or tissue jumped.
    void reset(const DistanceGrid& shell);
    /// Updates the grid near the points of `liquid` [m]. Where nothing has moved, only the search is paid
    /// for. `revision` must change whenever the shell does.
    void update(const DistanceGrid& shell, std::uint64_t revision, const pbd::Particles& tissue,
                std::span<const Vec3f> liquid);

    [[nodiscard]] const DistanceGrid& distance() const { return grid_; }
    /// Number of grid nodes computed by the last update.
    [[nodiscard]] std::size_t nodes() const { return outdated_.size() * block * block * block; }

    /// Ball radius over particle radius. Particles fill a cubic lattice with a spacing of two radii: from 1.5
    /// on their balls leave no gap in its faces. At 1.6, bulges and hollows balance, so that the boundary
    /// lies on average where the tissue ends.
    static constexpr float ball_size = 1.6f;

  private:
    /// A ball that moved less than this since its blocks were computed counts as unmoved: a fiftieth of the
    /// liquid's spacing, the threshold at which the liquid wakes.
    static constexpr float quantum = 17e-6f;  ///< [m]

    static constexpr int block = 4;  ///< nodes along an edge of a block, the unit of work

    void find_blocks(std::span<const Vec3f> liquid);
    void find_balls(const pbd::Particles& tissue);
    /// Finds the blocks near liquid whose nodes are out of date.
    void find_outdated();
    void touch(std::size_t which);
    void fill(std::uint32_t which, const DistanceGrid& shell);
    /// Lists the balls near a box for the kernels below; returns their number.
    struct Near;
    void find_near(const Vec3f& low, const Vec3f& high, Near& near) const;
    /// Distance of a point from the nearest ball; scalar and AVX2 versions.
    [[nodiscard]] static float nearest(const Near& near, const Vec3f& point);
    [[nodiscard]] static float nearest_avx2(const Near& near, const Vec3f& point);
    [[nodiscard]] Eigen::Vector3i block_of(const Vec3f& point) const;

    struct Ball {
        Vec3f centre = Vec3f::Zero();
        float radius = 0.0f;
    };

    float reach_, way_;
    DistanceGrid grid_;
    std::uint64_t revision_ = 0;
    Eigen::Vector3i blocks_along_ = Eigen::Vector3i::Zero();
    std::vector<Vec3f> known_;             ///< [particles][m], positions when their blocks were computed
    std::vector<std::uint32_t> outdated_;  ///< blocks to compute in this update
    std::vector<std::uint8_t>
        current_;                       ///< [blocks]: whether in the last update, and no ball in it has moved
    std::vector<std::uint8_t> before_;  ///< [blocks]: the same for the update before
    std::vector<std::uint8_t> moved_;   ///< [blocks]: whether a ball in it moved
    std::vector<std::uint32_t> blocks_;      ///< blocks near liquid
    std::vector<std::uint8_t> wanted_;       ///< [blocks]: whether it is in blocks_
    std::vector<Ball> ball_;                 ///< balls that may be near any of blocks_, sorted by block
    std::vector<Ball> unsorted_;             ///< the same in the order of the particles
    std::vector<std::uint32_t> ball_block_;  ///< block of each entry of unsorted_
    std::vector<std::uint32_t> first_ball_;  ///< [blocks]: index of its first ball
    float largest_ = 0.0f;                   ///< [m], largest ball radius
};

}  // namespace eti::scene
