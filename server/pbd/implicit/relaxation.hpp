// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "server/pbd/implicit/hexahedra.hpp"
#include "server/pbd/implicit/tetrahedra.hpp"

namespace eti::pbd {

/// Stress relaxation of an implicit mesh: one Prony term of the shear modulus,
///     mu(t) = mu (1 - share + share exp(-t / time)).
/// The relaxing share is a branch with a rest shape of its own (Reese & Govindjee 1998, Int J Solids Struct
/// 35:3455), of energy share mu V/2 (tr(C A) - 3): C = F^T F, and A is the inverse of the branch's viscous
/// right Cauchy-Green tensor. A is 1 at rest and follows (Lubliner 1985, Mech Res Commun 12:93)
///     time dA/dt = J^(2/3) C^-1 - A.
/// A deformation that is held keeps its shear stress times mu(t) / mu at any strain. Its pressure persists:
/// the bulk modulus does not relax. Rotations leave C, and hence A, unchanged.
///
/// An element's shear enters kernels by the metric M = Q Q^T alone, in which the branch's is Mv = Q A Q^T.
/// With the Gram matrix G = D^T D of the edges, J^(2/3) Q C^-1 Q^T = (det M)^(1/3) (det G)^(-2/3) adj G. A
/// step advances Mv by its exact solution for the edges at the step's begin, and takes
/// (1 - share) M + share Mv for M. As det A >= 1, clamped tangents stay positive definite, and the branch
/// loses energy while the mesh is held: J^(2/3) C^-1 minimises tr(C A) over det A >= 1. Of a hexahedron, G
/// is the mean over the cell, so that this includes its hourglass modes, but for their hardening.
///
/// Not modelled: the branch's rest shape is one per element, without hourglass modes: bending and twisting
/// within a cell do not relax.
struct Relaxation {
    float share = 0.0f;  ///< of the shear modulus; 0 to 1 (exclusive)
    float time = 1.0f;   ///< [s], of a held deformation; that of recovery is time / (1 - share)
    /// By which the branch's rest approaches its target in a step of `dt` [s]: the deformation, or the rest
    /// shape if it `recovers`.
    [[nodiscard]] float rate(float dt, bool recovers) const;
};

/// Mv of eight elements.
struct alignas(32) RelaxedMetric {
    float metric[6][Tetrahedra::lanes];  ///< 11, 22, 33, 23, 13, 12 [1/m^2]
};
static_assert(Tetrahedra::lanes == Hexahedra::lanes);

/// What kernels need of a step.
struct RelaxationStep {
    float share = 0.0f;     ///< as in Relaxation
    float rate = 0.0f;      ///< as in Relaxation
    bool recovers = false;  ///< to the rest shape; else to the current one
};

/// The branches' rest shapes of a mesh: its memory of past deformations. Not thread safe.
class RelaxationMemory {
  public:
    /// From now on the elements relax. Starts at rest.
    void configure(const Relaxation& relaxation, const Tetrahedra& tetrahedra, const Hexahedra& hexahedra);
    [[nodiscard]] bool enabled() const { return relaxation_.share > 0.0f; }
    /// Forgets all deformations.
    void reset(const Tetrahedra& tetrahedra, const Hexahedra& hexahedra);
    /// Where true, deformations are forgotten within a tenth of a second.
    void set_recovering(bool recovers) { recovers_ = recovers; }
    /// Of a step of `dt` [s].
    [[nodiscard]] RelaxationStep step(float dt) const;

    /// Call before and after the elements adopt another rest shape: A is kept, and turns with the element.
    void begin_rest(const Tetrahedra& tetrahedra, const Hexahedra& hexahedra);
    void end_rest(const Tetrahedra& tetrahedra, const Hexahedra& hexahedra);

    /// [blocks] of the elements; nullptr where nothing relaxes.
    [[nodiscard]] RelaxedMetric* tetrahedra() { return enabled() ? metric_.data() : nullptr; }
    [[nodiscard]] RelaxedMetric* hexahedra() { return enabled() ? metric_.data() + tetrahedra_ : nullptr; }
    /// [blocks of tetrahedra | blocks of hexahedra], of the last step.
    [[nodiscard]] std::span<const RelaxedMetric> metrics() const { return metric_; }

  private:
    Relaxation relaxation_;
    bool recovers_ = false;
    std::size_t tetrahedra_ = 0;               // blocks
    std::vector<RelaxedMetric> metric_, old_;  // [blocks of tetrahedra | of hexahedra]
};

}  // namespace eti::pbd
