// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/bench/server/accuracy/block_body.hpp"
#include "tests/validation/fem/static_solver.hpp"

namespace eti::bench {

/// One point of a force-depth curve.
struct ForceSample {
    double depth = 0.0;     ///< [m]
    double force = 0.0;     ///< [N]
    double expected = 0.0;  ///< [N]
};

inline constexpr double reference_cell = 1.25e-3;  ///< [m], of the finite elements

struct CaseResult {
    double error = 0.0;     ///< relative; not finite if the body diverged
    double frame_ms = 0.0;  ///< wall time per simulated 1/90 s
    std::size_t particles = 0;
    std::vector<ForceSample> curve;  ///< where forces are compared
};

/// A block of tissue under some load, with a reference: finite elements on cells of 1.25 mm, or a closed
/// form.
class BlockCase {
  public:
    virtual ~BlockCase() = default;
    [[nodiscard]] virtual std::string name() const = 0;
    /// Whether this spacing can resolve the case.
    [[nodiscard]] virtual bool fits(const BodySettings& setting) const = 0;
    [[nodiscard]] virtual CaseResult run(const BodySettings& setting) const = 0;
};

/// All cases; solving the references takes some seconds. `quick`: those that coarse blocks can resolve, with
/// references on cells twice as large.
[[nodiscard]] std::vector<std::unique_ptr<BlockCase>> block_cases(bool quick);

/// Indented blocks, compared by force.
void add_indentations(std::vector<std::unique_ptr<BlockCase>>& cases, bool quick);

/// The material of all cases on a lattice, and the lattice that references are solved on.
[[nodiscard]] fem::Problem problem_on(const test::TetrahedralLattice& lattice);
[[nodiscard]] test::TetrahedralLattice reference_lattice(int x_mm, int y_mm, int z_mm,
                                                         double cell = reference_cell);

}  // namespace eti::bench
