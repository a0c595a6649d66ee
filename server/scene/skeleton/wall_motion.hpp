// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/distance_grid.hpp"
#include "server/scene/skeleton/yielding_skeleton.hpp"

namespace eti::scene {

/// How the shell's walls have moved since their distances were computed, as the bones that carry them yield:
/// a field of displacements on a coarse lattice around the shell. Distances of moved walls are looked up
/// where the wall was. Not thread safe, but for in_reference() and carrier_at().
class WallMotion {
  public:
    WallMotion() = default;
    /// `posed` [vertices][m]: the shell in the reference configuration, in which the `skeleton` is now;
    /// `carriers` [vertices].
    WallMotion(std::span<const Vec3f> posed, std::span<const YieldingSkeleton::Carrier> carriers,
               const YieldingSkeleton& skeleton);

    /// Follows the skeleton.
    void update(const YieldingSkeleton& skeleton);
    /// Where the wall material now at `point` [m] was in the reference configuration.
    [[nodiscard]] Vec3f in_reference(const Vec3f& point) const {
        if (!moved_) {
            return point;
        }
        // Two steps of a fixed-point iteration: strains of the field are below a fifth.
        return point - displacement(point - displacement(point));
    }
    /// What carries the wall near a point of the reference configuration.
    [[nodiscard]] YieldingSkeleton::Carrier carrier_at(const Vec3f& point) const;
    /// Offset of the skeleton in which the walls are.
    [[nodiscard]] const YieldingSkeleton::Vector& at() const { return at_; }
    /// [m], sum of the greatest displacements of all updates: no wall has moved farther between two values.
    [[nodiscard]] float travel() const { return travel_; }

  private:
    /// Lattice cell of a point, and its place in it from 0 to 1.
    struct Place {
        std::size_t first = 0;
        Vec3f share = Vec3f::Zero();
    };
    [[nodiscard]] Place place_of(const Vec3f& point) const;
    /// Calls body(node, weight) for the lattice cell around a point.
    template <class Body>
    void for_nodes_around(const Vec3f& point, const Body& body) const;
    [[nodiscard]] Vec3f displacement(const Vec3f& point) const;

    Vec3f origin_ = Vec3f::Zero();  // [m]
    std::array<std::size_t, 3> size_{};
    struct Node {
        std::uint32_t number;
        Vec3f position;  // [m]
    };
    std::vector<Node> nodes_;            // those near a wall that moves
    std::vector<Vec3f> displacement_;    // [lattice nodes][m]
    patient::BonePoses from_reference_;  // inverse poses of the bones in the reference configuration
    YieldingSkeleton::Vector reference_ = YieldingSkeleton::Vector::Zero();
    YieldingSkeleton::Vector at_ = YieldingSkeleton::Vector::Zero();
    float travel_ = 0.0f;
    bool moved_ = false;
    std::vector<YieldingSkeleton::Carrier> carrier_;  // [lattice nodes]
};

/// The shell as an obstacle: its signed distances, and how it has moved since they were computed.
struct Walls {
    const DistanceGrid& grid;
    std::uint64_t revision = 1;          ///< changes whenever the grid does
    const WallMotion* motion = nullptr;  ///< nullptr: none

    // NOLINTNEXTLINE(google-explicit-constructor): a grid is walls that stand still
    Walls(const DistanceGrid& distances, std::uint64_t version = 1, const WallMotion* moved = nullptr)
        : grid(distances), revision(version), motion(moved) {}

    [[nodiscard]] Vec3f in_grid(const Vec3f& point) const {
        return motion == nullptr ? point : motion->in_reference(point);
    }
    [[nodiscard]] float travel() const { return motion == nullptr ? 0.0f : motion->travel(); }
    [[nodiscard]] float distance(const Vec3f& point) const { return grid.distance(in_grid(point)); }
    [[nodiscard]] DistanceSample sample(const Vec3f& point) const { return grid.sample(in_grid(point)); }
    [[nodiscard]] SplineDistance spline_sample(const Vec3f& point) const {
        return grid.spline_sample(in_grid(point));
    }
};

}  // namespace eti::scene
