// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/pbd/implicit/element_order.hpp"
#include "server/pbd/particles.hpp"

namespace eti::pbd {

/// Rest shapes and moduli of a tetrahedral mesh of stable neo-Hookean material (Macklin & Müller 2021; see
/// neo_hookean.hpp), in blocks for vector kernels.
class Tetrahedra {
  public:
    struct Description {
        std::vector<std::array<std::uint32_t, 4>> tetrahedra;  ///< particle indices, in any orientation
        std::vector<float> youngs_modulus;                     ///< [tetrahedra][Pa]
        /// 0.2 to 0.499. Below, a crumpled mesh may not recover; nearer to 0.5, linear elements lock.
        float poisson_ratio = 0.45f;
    };

    /// Sorts along a space-filling curve and colours, so that the order of solution depends on rest
    /// positions, not on the order of particles or tetrahedra.
    void configure(const Description& description, const Particles& particles);
    /// The same as part of a mesh with other elements, whose corners are numbered together.
    void configure(const Description& description, const Particles& particles,
                   const CornerNumbering& numbering);

    /// Adopts `particles.rest` as the new unloaded shape (after a change of posture).
    void set_rest(const Particles& particles);

    /// Sets the `moduli` [tetrahedra][Pa]; the rest shape is unchanged.
    void set_youngs_modulus(std::span<const float> moduli);

    [[nodiscard]] std::size_t size() const { return place_.size(); }
    /// [corners]: particle indices.
    [[nodiscard]] std::span<const std::uint32_t> particles() const { return used_; }
    [[nodiscard]] std::size_t colours() const { return first_block_.empty() ? 0 : first_block_.size() - 1; }
    /// Sum of the rest volumes [m^3].
    [[nodiscard]] double volume() const;

    static constexpr std::size_t lanes = 8;
    /// Eight tetrahedra without common particles. Lanes that fill up a colour's last block have corners of
    /// their own, after those of the mesh, and no stiffness.
    struct alignas(32) Block {
        std::uint32_t corner[4][lanes];    ///< four times the corner index
        float metric[6][lanes];            ///< see RestTetrahedron
        float inverse_determinant[lanes];  ///< see RestTetrahedron
        float stiffness[lanes];            ///< mu V [N m]; 0 for a tetrahedron without volume at rest
    };

    /// Blocks that are processed concurrently: no particle occurs twice among them.
    [[nodiscard]] std::span<const Block> blocks(std::size_t colour) const {
        return {block_.data() + first_block_[colour], block_.data() + first_block_[colour + 1]};
    }
    /// All of them, by colour.
    [[nodiscard]] std::span<const Block> blocks() const { return block_; }

  private:
    void set_rest_of(std::size_t tetrahedron, const Particles& particles);

    std::vector<Block> block_;
    std::vector<std::uint32_t> first_block_;  // [colours + 1]
    std::vector<std::uint32_t> place_;        // [tetrahedra]: lanes * block + lane
    std::vector<float> shear_modulus_;        // [tetrahedra][Pa]
    std::vector<float> volume_;               // [tetrahedra][m^3], at rest; 0 where it is flat
    std::vector<std::uint32_t> used_;         // [corners]: particle indices
    float poisson_ratio_ = 0.45f;
};

}  // namespace eti::pbd
