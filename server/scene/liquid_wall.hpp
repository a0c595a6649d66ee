// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/distance_grid.hpp"
#include "server/pbd/particles.hpp"

namespace eti::scene {

/// What liquid rests on: the offset shell, and before it the soft tissue's particles as balls. Written into
/// one distance grid on the shell's nodes, but only where liquid is: elsewhere it keeps what was there last.
/// The liquid does not push back on the tissue.
class LiquidWall {
  public:
    /// `reach` [m]: distances are right up to here from the tissue. `way` [m]: liquid goes no farther between
    /// two updates than the wall is kept right for.
    LiquidWall(float reach, float way) : reach_(reach), way_(way) {}

    /// Forgets all tissue. Call it when shell or tissue jumped.
    void reset(const DistanceGrid& shell);
    /// Brings the grid up to date about the points of `liquid` [m]. Where nothing moved since the last time
    /// this costs nothing but the search. `revision`: changes whenever the shell does.
    void update(const DistanceGrid& shell, std::uint64_t revision, const pbd::Particles& tissue,
                std::span<const Vec3f> liquid);

    [[nodiscard]] const DistanceGrid& distance() const { return grid_; }
    /// Grid nodes that the last update computed.
    [[nodiscard]] std::size_t nodes() const { return due_.size() * block * block * block; }

    /// Of a ball over its particle's radius. Particles fill a cubic lattice two radii wide: from 1.5 on their
    /// balls leave no way through its faces, and at 1.6 they stand out as far as they leave hollows, so that
    /// the wall lies in the mean where the tissue ends.
    static constexpr float ball_size = 1.6f;

  private:
    /// A ball that moved less since its blocks were last computed counts as unmoved: a fiftieth of the
    /// spacing of liquid, which is what wakes it.
    static constexpr float quantum = 17e-6f;  ///< [m]

    static constexpr int block = 4;  ///< nodes along an edge of what is worked on at a time

    void find_blocks(std::span<const Vec3f> liquid);
    void find_balls(const pbd::Particles& tissue);
    /// Those of the blocks near the liquid whose nodes are out of date.
    void find_due();
    void touch(std::size_t which);
    void fill(std::uint32_t which, const DistanceGrid& shell);
    /// Lists the balls near a box for the kernel below; returns how many there are.
    struct Near;
    void find_near(const Vec3f& low, const Vec3f& high, Near& near) const;
    /// Distance of a point from the nearest of them, and the same for AVX2.
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
    std::vector<Vec3f> known_;        ///< [m], where each particle was when its blocks were computed
    std::vector<std::uint32_t> due_;  ///< blocks to compute in this update
    std::vector<std::uint8_t>
        current_;                       ///< of every block, whether the last update had it, and no ball moved
    std::vector<std::uint8_t> before_;  ///< the same of the update before
    std::vector<std::uint8_t> moved_;   ///< of every block, whether a ball in it moved
    std::vector<std::uint32_t> blocks_;  ///< near the liquid
    std::vector<std::uint8_t> wanted_;   ///< of every block, whether it is one of those
    std::vector<Ball> ball_;             ///< that may come near any of them, sorted by their block
    std::vector<Ball> unsorted_;
    std::vector<std::uint32_t> ball_block_;  ///< of the unsorted
    std::vector<std::uint32_t> first_ball_;  ///< of every block
    float largest_ = 0.0f;                   ///< [m], radius of a ball
};

}  // namespace eti::scene
