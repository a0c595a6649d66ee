// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/pbd/particles.hpp"

namespace eti::pbd {

/// A tetrahedral mesh of stable neo-Hookean material in XPBD (Macklin & Müller 2021; see neo_hookean.hpp).
///
/// One pass per substep makes statics too soft, by 0.05 to 0.4 of (dt c / h)^2, with the speed of pressure
/// waves c = sqrt(E (1 - nu) / ((1 + nu) (1 - 2 nu) density)) and the edge length h: half the substep gives a
/// quarter of the error. Cells of 2.5 mm of 5 kPa and nu = 0.45: 11 % at 1/1500 s, 3 % at 1/3000 s.
class Tetrahedra {
  public:
    /// Largest stable modulus [Pa] of meshes of `spacing` [m] and `density` [kg/m^3] at this `substep` [s];
    /// stiffer ones eventually explode. From the stability maps (docs/solver/stability.md): with E substep^2
    /// / (density spacing^2) at 0.8 all disturbed blocks recovered, at 1.5 none.
    [[nodiscard]] static float max_stable_modulus(float spacing, float density, float substep) {
        return 0.8f * density * (spacing / substep) * (spacing / substep);
    }

    struct Description {
        std::vector<std::array<std::uint32_t, 4>> tetrahedra;  ///< particle indices, in any orientation
        std::vector<float> youngs_modulus;                     ///< [Pa], per tetrahedron
        /// 0.2 to 0.499. Below, a crumpled mesh may not recover; nearer to 0.5, linear elements lock.
        float poisson_ratio = 0.45f;
    };

    /// Sorts along a space-filling curve and colours, so that the order of solution depends on rest
    /// positions, not on the order of particles or tetrahedra.
    void configure(const Description& description, const Particles& particles);

    /// Adopts `particles.rest` as the new unloaded shape (after a change of posture).
    void set_rest(const Particles& particles);

    /// Sets the moduli [Pa], one per tetrahedron as described; shape and state are unchanged.
    void set_youngs_modulus(std::span<const float> moduli);

    /// One Gauss-Seidel pass: moves the free particles' predicted positions. Substep `dt` [s]. Bit-identical
    /// for any number of threads. Does not allocate.
    void project(Particles& particles, float dt);

    /// Enables AVX2; configure() sets it to what the processor supports. Results are bit-identical either
    /// way.
    void use_avx2(bool wanted) { avx2_ = wanted; }

    [[nodiscard]] std::size_t size() const { return place_.size(); }
    /// The particles that are corners.
    [[nodiscard]] std::span<const std::uint32_t> particles() const { return used_; }
    [[nodiscard]] std::size_t colours() const { return first_block_.empty() ? 0 : first_block_.size() - 1; }
    /// Number of tetrahedra without volume at rest; they are skipped until a rest shape gives them one.
    [[nodiscard]] std::size_t flat() const { return flat_; }

    static constexpr std::size_t lanes = 8;
    /// Eight tetrahedra without common particles.
    struct alignas(32) Block {
        std::uint32_t corner[4][lanes];    ///< offset of the particle in wide_
        float metric[6][lanes];            ///< see RestTetrahedron
        float inverse_determinant[lanes];  ///< see RestTetrahedron
        float stiffness[lanes];            ///< mu V [N m]
    };

    /// Blocks that are processed concurrently: no particle occurs twice among them.
    [[nodiscard]] std::span<const Block> blocks(std::size_t colour) const {
        return {block_.data() + first_block_[colour], block_.data() + first_block_[colour + 1]};
    }

  private:
    void set_rest_of(std::size_t tetrahedron, const Particles& particles);

    std::vector<Block> block_;
    std::vector<std::uint32_t> first_block_;  // [colours + 1]
    std::vector<std::uint32_t> place_;        // [tetrahedra]: lanes * block + lane
    std::vector<float> shear_modulus_;        // [tetrahedra][Pa]
    std::vector<float> volume_;               // [tetrahedra][m^3], at rest; 0 where it is flat
    std::vector<std::uint32_t> used_;         // particles, in the order of wide_
    // Predicted position and inverse mass of the particles in use, then padding for the last block of each
    // colour, which never moves.
    std::vector<Eigen::Vector4f> wide_;
    float poisson_ratio_ = 0.45f;
    float ratio_ = 1.0f;
    std::size_t flat_ = 0;
    bool avx2_ = false;
};

}  // namespace eti::pbd
