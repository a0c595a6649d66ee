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

// A trilinear cell's corner positions as a sum of modes: with corner numbers v and mode numbers a, both bits
// along the cell's axes, mode a has the sign of the product of the axes in a. Mode 0 is the mean, 1, 2 and 4
// are the mean edges, and the other four are hourglass modes.

/// The four modes that bend and twist a cell without changing its mean edges.
inline constexpr std::array<unsigned, 4> hourglass_modes = {3, 5, 6, 7};

/// Sign of `mode` at a corner: +1 or -1.
[[nodiscard]] constexpr int hexahedron_sign(unsigned mode, unsigned corner) {
    // Each axis of the mode at whose low end the corner lies turns the sign.
    const unsigned turned = mode & ~corner;
    return ((turned >> 0 ^ turned >> 1 ^ turned >> 2) & 1u) != 0 ? -1 : 1;
}

/// Rest shapes and moduli of 8-node hexahedra of stable neo-Hookean material, in blocks for vector kernels
/// (see hexahedron_kernels.hpp for the element). Cells are taken as parallelepipeds: those of a posed lattice
/// deviate from one by second differences of the posture.
class Hexahedra {
  public:
    using Corners = std::array<std::uint32_t, 8>;

    struct Description {
        /// Particle indices; bit b of a corner's number is its position (0 or 1) along axis b of the cell.
        std::vector<Corners> hexahedra;
        std::vector<float> youngs_modulus;  ///< [hexahedra][Pa]
        float poisson_ratio = 0.49f;        ///< 0.2 to 0.499
    };

    void configure(const Description& description, const Particles& particles,
                   const CornerNumbering& numbering);
    /// Adopts `particles.rest` as the new unloaded shape (after a change of posture).
    void set_rest(const Particles& particles);
    /// Sets the `moduli` [hexahedra][Pa]; the rest shape is unchanged.
    void set_youngs_modulus(std::span<const float> moduli);

    [[nodiscard]] std::size_t size() const { return corners_.size(); }
    [[nodiscard]] std::size_t colours() const { return first_block_.empty() ? 0 : first_block_.size() - 1; }
    /// Sum of the rest volumes [m^3].
    [[nodiscard]] double volume() const;

    static constexpr std::size_t lanes = 8;
    /// Eight cells without common particles; padding as in Tetrahedra::Block.
    struct alignas(32) Block {
        std::uint32_t corner[8][lanes];  ///< four times the corner index
        /// Q Q^T with Q the inverse of the mean edges at rest: 11, 22, 33, 23, 13, 12 [1/m^2]
        float metric[6][lanes];
        float inverse_determinant[lanes];  ///< det Q [1/m^3]
        float stiffness[lanes];            ///< mu V [N m]
        float warp[4][3][lanes];           ///< the rest shape's hourglass modes, in mean edges
    };
    /// Blocks that are processed concurrently: no particle occurs twice among them.
    [[nodiscard]] std::span<const Block> blocks(std::size_t colour) const {
        return {block_.data() + first_block_[colour], block_.data() + first_block_[colour + 1]};
    }
    /// All of them, by colour.
    [[nodiscard]] std::span<const Block> blocks() const { return block_; }

  private:
    void set_rest_of(std::size_t cell, const Particles& particles);

    std::vector<Corners> corners_;
    std::vector<Block> block_;
    std::vector<std::uint32_t> first_block_;  // [colours + 1]
    std::vector<std::uint32_t> place_;        // [cells]: lanes * block + lane
    std::vector<float> shear_modulus_;        // [cells][Pa]
    std::vector<float> volume_;               // [cells][m^3], at rest
    float poisson_ratio_ = 0.49f;
};

}  // namespace eti::pbd
