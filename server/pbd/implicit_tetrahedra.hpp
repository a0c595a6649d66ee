// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/pbd/coarse_level.hpp"
#include "server/pbd/mesh_contact.hpp"
#include "server/pbd/tetrahedra.hpp"

namespace eti::pbd {

/// A tetrahedral mesh of stable neo-Hookean material (see neo_hookean.hpp), whose projection is finished: one
/// step of implicit Euler, which XPBD's passes approach only with ever shorter substeps. It minimises
///     1/(2 dt^2) (x - x~)^T M (x - x~) + Psi(x),   x~ = position + dt velocity
/// by one Newton step from the last position, solved by a fixed count of conjugate gradients without
/// assembling the matrix, preconditioned by the particles' own 3x3 blocks and by how the body moves at large
/// (see CoarseLevel). With the element's
/// P = sum p_v Q_v (rows of Q)
///     K P = mu V (f P Q Q^T + (H : P) H / r + s dcof[P]),  H = det Q cof D,  s = (J - 1 - r) / r,
/// r = mu / lambda; s is cut to what keeps every element's matrix positive (dcof's eigenvalues are at most
/// the largest stretch, for which (I1 + 2 sqrt(I1^2 - 3 I2)) / 3 is a bound, exact at rest), and f makes up
/// for what the cut takes of those that are stiffer. Neither changes the equilibrium, nor do too few
/// iterations: from the last position they err in time and not at rest, as a guess by inertia would under a
/// lasting load. A body that nothing holds is therefore slow to fall, and bounces on contacts: this is for
/// bodies that hang on something and are overdamped. Gradients: Macklin & Müller 2021; the energy: Smith, de
/// Goes & Kim 2018.
class ImplicitTetrahedra {
  public:
    struct Settings {
        int iterations = 8;  ///< of conjugate gradients; cost grows linearly
        /// Of contacts, in parts of their particles' own stiffness. Contacts find their force within a few
        /// steps; three times as firm, a tongue of 1 mm trembles between blade and jaw.
        float firmness = 0.3f;
    };
    Settings settings;

    /// A spring to a place that does not give way within a step.
    struct Spring {
        std::uint32_t particle = 0;
        Vec3f to = Vec3f::Zero();
        float stiffness = 0.0f;  ///< [N/m]
    };
    /// Both are the caller's to fill; particles have to be corners that move.
    std::vector<Spring> springs;
    std::vector<MeshContact> contacts;

    /// `inverse_mass` [1/kg] by particle; those of 0 go where `predicted` has them.
    void configure(const Tetrahedra::Description& description, const Particles& particles,
                   std::span<const float> inverse_mass);
    /// As Tetrahedra's.
    void set_rest(const Particles& particles);
    void set_youngs_modulus(std::span<const float> moduli);

    /// Moves `particles.predicted`, where they are before the step (those that are held: where they are to
    /// be), to the end of a step of `dt` [s], and takes the contacts' forces on. No particle goes farther
    /// than half a cell from where it was predicted, else all go as much less: beyond, the linearised
    /// material says nothing. The same bits for any number of threads. Does not allocate once the counts are
    /// known.
    void solve(Particles& particles, float dt);
    /// The same in two parts; springs and contacts may be filled in beside the first.
    void linearise(const Particles& particles, float dt);
    void solve_linearised(Particles& particles, float dt);

    /// The particles that are corners, in the order of the functions below.
    [[nodiscard]] std::span<const std::uint32_t> particles() const { return mesh_.particles(); }
    [[nodiscard]] std::size_t size() const { return mesh_.size(); }
    /// [1/kg]
    [[nodiscard]] float inverse_mass(std::size_t corner) const { return inverse_mass_[corner]; }
    /// [N/m], what a corner has against being moved alone, at rest; mean over directions.
    [[nodiscard]] float own_stiffness(std::size_t corner) const { return own_stiffness_[corner]; }

    /// Whether to use AVX2: set by configure() to what the processor has. The bits are the same without.
    void use_avx2(bool wanted) { avx2_ = wanted; }

    /// What an iteration needs to know of eight tetrahedra.
    struct alignas(32) Element {
        float metric[6][Tetrahedra::lanes];   ///< mu V Q Q^T [N/m]
        float edge[3][3][Tetrahedra::lanes];  ///< [m], columns of D
        float bulk[Tetrahedra::lanes];        ///< lambda V det^2 Q [N/m^5]
        float pressure[Tetrahedra::lanes];    ///< mu V s det Q, s as cut [N/m^2]
    };

  private:
    using Wide = CoarseLevel::Wide;  // by corner, and behind them those that fill up blocks

    /// Some of the tetrahedra, neighbours in space, that one thread works at, and what their corners get from
    /// them. The cut hangs on the mesh alone.
    struct Part {
        std::vector<std::array<std::uint32_t, 2>> blocks;  // ranges of the mesh's
        std::uint32_t first = 0, end = 0;                  // corners
        // Per corner: gradient and, fourth, the diagonal's part that all axes share; the rest of its diagonal
        // block: xx yy zz, yz zx xy; and the image of a direction.
        Wide gradient, square, mixed, image;
        float curvature = 0.0f;  // of along_ [J]
    };
    struct Inverse {
        Eigen::Vector4f column[3];
    };
    /// Corners that one thread works at, and what the conjugate gradients sum over them.
    struct Range {
        std::size_t first = 0, end = 0;
        float product = 0.0f;    // of residual and preconditioned residual, the blocks' part [J]
        float curvature = 0.0f;  // of along_, by mass and springs [J]
        CoarseLevel::Motion force;
    };

    void cut();
    void measure_own_stiffness();
    /// The parts' sums where x_ has the corners.
    void linearise_elements();
    void add_springs(const Particles& particles);
    void add_contacts();
    void conjugate_gradients();
    void invert_blocks(const Range& range);
    /// The residual as the corners' own blocks would have it moved, and what coarse motions need of it.
    void precondition(Range& range);
    /// Ends that: returns the product of the residual and what both levels would have it moved by [J].
    [[nodiscard]] float join_levels();
    /// The next direction, by how much it keeps of the last.
    void turn(Range& range, float keep);
    /// The parts' images of along_, and the curvature along it [J].
    [[nodiscard]] float apply();
    /// Goes along by so much.
    void advance(const Range& range, float way);
    void advance_contacts(float way);
    /// What a contact holds of along_.
    [[nodiscard]] Vec3f way_held(const MeshContact& contact) const;
    [[nodiscard]] std::array<std::uint32_t, 2> corners_of(const MeshContact& contact) const {
        return {corner_of_[contact.particle[0]], corner_of_[contact.particle[1]]};
    }

    Tetrahedra mesh_;
    std::vector<Part> parts_;
    std::vector<Range> ranges_;
    std::vector<Element> element_;          // as the mesh's blocks
    std::vector<std::uint32_t> corner_of_;  // by particle
    std::vector<float> inverse_mass_, own_stiffness_;
    float ratio_ = 1.0f;         // mu / lambda
    float longest_step_ = 0.0f;  // [m]
    bool avx2_ = false;
    Wide rest_, x_, diagonal_, square_, mixed_, residual_, along_, moved_, step_;
    std::vector<Inverse> inverse_;
    CoarseLevel coarse_;
    CoarseLevel::Motion coarse_force_;
    float configured_modulus_ = 0.0f;  // [Pa], sum over tetrahedra
};

}  // namespace eti::pbd
