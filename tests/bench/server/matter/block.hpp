// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "server/pbd/soft/implicit_mesh.hpp"
#include "server/scene/tongue_contacts.hpp"

namespace eti::bench {

/// The elements of a block.
enum class Element : std::uint8_t { tetrahedra, hexahedra };

struct BlockSettings {
    Element element = Element::hexahedra;
    std::array<double, 3> size = {20e-3, 20e-3, 10e-3};  ///< [m]
    double cell = 2e-3;                                  ///< [m]
    double youngs_modulus = 8e3;                         ///< [Pa]
    double poisson_ratio = 0.49;
    double dt = 1.0 / 180.0;  ///< [s]
    int iterations = 8;
    double damping = 20.0;  ///< [1/s]
};

/// A block of one material in a lattice of cubes, its lowest corner at the origin, advanced by one solve per
/// step, and pressed by a capsule with the scene's own contact search.
class Block {
  public:
    explicit Block(const BlockSettings& settings);

    /// Holds particles at rest; call before start().
    void hold(const std::function<bool(const Vec3d&)>& those);
    void start();
    /// Axis and radius of the capsule, from the next step on.
    void place_capsule(const Vec3d& a, const Vec3d& b, double radius);

    Vec3d gravity = Vec3d::Zero();  ///< [m/s^2]
    void step();
    /// Greatest speed of a particle [m/s].
    [[nodiscard]] double speed() const;
    /// Steps until the greatest speed is below `slow` for ten steps, at most `most` times.
    int settle(double slow = 1e-6, int most = 4000);
    /// [N], of the capsule on the block.
    [[nodiscard]] Vec3d contact_force() const;

    /// Displacement [m] of a point of the unloaded block, trilinear in its cell.
    [[nodiscard]] Vec3d displacement_at(const Vec3d& rest) const;

    [[nodiscard]] const pbd::Particles& particles() const { return particles_; }

  private:
    [[nodiscard]] std::uint32_t index_of(int x, int y, int z) const {
        return static_cast<std::uint32_t>((z * (count_[1] + 1) + y) * (count_[0] + 1) + x);
    }

    BlockSettings settings_;
    std::array<int, 3> count_{};  // cells
    std::vector<Vec3d> rest_;
    std::vector<std::array<std::uint32_t, 4>> tetrahedra_;
    std::vector<std::array<std::uint32_t, 8>> cells_;
    pbd::Particles particles_;
    pbd::ImplicitMesh mesh_;
    scene::TongueContacts contacts_;
    Laryngoscope scope_;
    DistanceGrid nothing_;
    bool pressed_ = false;
};

}  // namespace eti::bench
