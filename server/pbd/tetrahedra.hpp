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
/// One pass per substep leaves statics too soft, by 0.05 to 0.4 of (dt c / h)^2, with c the speed of pressure
/// waves, sqrt(E (1 - nu) / ((1 + nu) (1 - 2 nu) density)), and h an edge: half the substep for a quarter of
/// the error. Cells of 2.5 mm of 5 kPa and nu = 0.45: 11 % at 1/1500 s, 3 % at 1/3000 s.
class Tetrahedra {
  public:
    /// [Pa]; stiffer meshes of `spacing` [m] and `density` [kg/m^3] fly apart at this `substep` [s], sooner
    /// or later. From the stability maps (docs/solver/stability.md): with E substep^2 / (density spacing^2)
    /// at 0.8 all disturbed blocks came back, at 1.5 none.
    [[nodiscard]] static float stiffest(float spacing, float density, float substep) {
        return 0.8f * density * (spacing / substep) * (spacing / substep);
    }

    struct Description {
        std::vector<std::array<std::uint32_t, 4>> tetrahedra;  ///< particle indices, in any orientation
        std::vector<float> youngs_modulus;                     ///< [Pa], per tetrahedron
        /// 0.2 to 0.499. Below, a crumpled mesh may stay so; nearer to 0.5, linear elements lock.
        float poisson_ratio = 0.45f;
    };

    /// Sorts along a space-filling curve and colours, so that the order of solution depends on the
    /// places at rest and not on the order of particles or tetrahedra.
    void configure(const Description& description, const Particles& particles);

    /// Takes `particles.rest` as the new unloaded shape (after a change of posture).
    void set_rest(const Particles& particles);

    /// Takes other moduli [Pa], one per tetrahedron as described; shape and state stay.
    void set_youngs_modulus(std::span<const float> moduli);

    /// One Gauss-Seidel pass: moves the free particles' predicted positions. Substep `dt` [s]. The same
    /// bits for any number of threads. Does not allocate.
    void project(Particles& particles, float dt);

    /// Whether to use AVX2: set by configure() to what the processor has. The bits are the same without.
    void use_avx2(bool wanted) { avx2_ = wanted; }

    [[nodiscard]] std::size_t size() const { return place_.size(); }
    /// The particles that are corners.
    [[nodiscard]] std::span<const std::uint32_t> particles() const { return used_; }
    [[nodiscard]] std::size_t colours() const { return first_block_.empty() ? 0 : first_block_.size() - 1; }
    /// Tetrahedra without volume at rest; they are left out until a rest shape gives them one.
    [[nodiscard]] std::size_t flat() const { return flat_; }

    static constexpr std::size_t lanes = 8;
    /// Eight tetrahedra that share no particle.
    struct alignas(32) Block {
        std::uint32_t corner[4][lanes];    ///< the particle's first number in wide_
        float metric[6][lanes];            ///< see RestTetrahedron
        float inverse_determinant[lanes];  ///< see RestTetrahedron
        float stiffness[lanes];            ///< mu V [N m]
    };

    /// The blocks that run at the same time: no particle occurs twice among them.
    [[nodiscard]] std::span<const Block> blocks(std::size_t colour) const {
        return {block_.data() + first_block_[colour], block_.data() + first_block_[colour + 1]};
    }

  private:
    void set_rest_of(std::size_t tetrahedron, const Particles& particles);

    std::vector<Block> block_;
    std::vector<std::uint32_t> first_block_;  // by colour, count + 1
    std::vector<std::uint32_t> place_;        // by tetrahedron: lanes * block + lane
    std::vector<float> shear_modulus_;        // [Pa], by tetrahedron
    std::vector<float> volume_;               // [m^3], at rest, by tetrahedron; 0 where it is flat
    std::vector<std::uint32_t> used_;         // particles in the order of wide_
    // Predicted position and inverse mass of the particles in use, then those that fill up the last block
    // of a colour, which never move.
    std::vector<Eigen::Vector4f> wide_;
    float poisson_ratio_ = 0.45f;
    float ratio_ = 1.0f;
    std::size_t flat_ = 0;
    bool avx2_ = false;
};

}  // namespace eti::pbd
