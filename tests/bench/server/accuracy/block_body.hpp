// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "server/pbd/implicit/implicit_mesh.hpp"
#include "server/pbd/soft/cluster_calibration.hpp"
#include "server/pbd/soft/shape_matching.hpp"
#include "tests/support/lattice_clusters.hpp"
#include "tests/support/mass_springs.hpp"
#include "tests/support/tetrahedral_lattice.hpp"

namespace eti::bench {

enum class Method {
    shape_matching_pbd,
    shape_matching_xpbd,
    clusters_for_traction,     ///< the same, with the input modulus calibrated for a bar's modulus
    clusters_for_indentation,  ///< for the force on an indenter,
    clusters_for_tongue,       ///< or for the force of the patient's tongue, as shipped
    tetrahedra_implicit,       ///< one solve per step instead of one pass per substep
    hexahedra_implicit,        ///< the same with 8-node cells, as shipped for the tongue
    mass_springs
};

[[nodiscard]] constexpr std::string_view name_of(Method method) {
    switch (method) {
        case Method::shape_matching_pbd:
            return "shape matching, PBD";
        case Method::shape_matching_xpbd:
            return "shape matching, XPBD";
        case Method::clusters_for_traction:
            return "clusters, calibrated by traction";
        case Method::clusters_for_indentation:
            return "clusters, calibrated by indentation";
        case Method::clusters_for_tongue:
            return "clusters, calibrated on the tongue";
        case Method::tetrahedra_implicit:
            return "tetrahedra, implicit";
        case Method::hexahedra_implicit:
            return "hexahedra, implicit";
        case Method::mass_springs:
            break;
    }
    return "mass-spring, explicit";
}

[[nodiscard]] constexpr bool is_implicit(Method method) {
    return method == Method::tetrahedra_implicit || method == Method::hexahedra_implicit;
}

/// What the input modulus of clusters is calibrated for; empty if it is not calibrated.
[[nodiscard]] constexpr std::optional<pbd::ClusterLoad> calibration_of(Method method) {
    switch (method) {
        case Method::clusters_for_traction:
            return pbd::ClusterLoad::traction;
        case Method::clusters_for_indentation:
            return pbd::ClusterLoad::indentation;
        case Method::clusters_for_tongue:
            return pbd::ClusterLoad::tongue;
        default:
            return std::nullopt;
    }
}

/// How a body is simulated.
struct BodySettings {
    Method method = Method::shape_matching_xpbd;
    double cell = 2.5e-3;         ///< [m]
    int substeps = 8;             ///< per step
    int iterations = 1;           ///< passes per substep; of the implicit method, conjugate gradients
    double step = 1.0 / 180.0;    ///< [s]
    double youngs_modulus = 8e3;  ///< [Pa], of tongue and mucosa
    double poisson_ratio = 0.45;  ///< of implicit methods; clusters have 0, springs 1/4
    /// [1/s], of velocity; by default at most the rate of the slowest mode of the loaded cases.
    double damping = 40.0;
    double cluster_radius = test::cube_radius;  ///< in cells
};

inline constexpr double particle_density = 4e3;  ///< [kg/m^3], as of the patient's particles
inline constexpr double implicit_density = 1e3;  ///< [kg/m^3] of the implicit method: tissue's own

/// A block of soft tissue, one corner at the origin, on a lattice common to all methods: particles at its
/// nodes, tetrahedra or hexahedra in its cells, clusters around every second node, springs along edges and
/// diagonals.
class BlockBody {
  public:
    /// Size along x, y, z [mm]: an even number of cells each, so that clusters cover the block.
    BlockBody(int x_mm, int y_mm, int z_mm, const BodySettings& setting);

    [[nodiscard]] const test::TetrahedralLattice& lattice() const { return lattice_; }
    [[nodiscard]] pbd::Particles& particles() { return particles_; }
    [[nodiscard]] double mass(std::size_t i) const { return mass_[i]; }
    void scale_mass(std::size_t i, double factor);
    /// Its clusters while settle() runs; none for implicit methods.
    [[nodiscard]] const pbd::ShapeMatching& shapes() const { return shapes_; }

    /// Holds a particle at its rest position plus `displacement` [m], reached over the first half second.
    void hold(std::size_t i, const Vec3d& displacement = Vec3d::Zero());
    /// The same for particles that follow a path: position at share 0..1 of the path.
    void hold_along(std::size_t i, std::function<Vec3d(double)> path);

    Vec3d gravity = Vec3d::Zero();  ///< [m/s^2], as if the density were 1000 kg/m^3
    std::vector<Vec3d> force;       ///< [N], per particle

    /// After the constraints of a substep; moves predicted positions. Arguments: substep [s], current share
    /// of the load. Not for the implicit method, which needs all forces before it solves:
    std::function<void(pbd::Particles&, double, double)> contact;
    /// before and after a solve; with the substep [s].
    std::function<void(pbd::ImplicitMesh&, const pbd::Particles&, double)> before_solve, after_solve;

    /// Before every step, if set: returns the number of substeps.
    std::function<int()> cut;

    /// After every step.
    std::function<void(const pbd::Particles&)> watch;

    /// Makes the body from the particles that are held by now.
    void start();
    /// Advances by the setting's step under a share of the load, or of all that grow to it.
    void step(double share_before, double share_after);
    void step() { step(1.0, 1.0); }
    /// Steps until the greatest speed has been below `slow` [m/s] for ten steps, at most `most` times;
    /// returns their number.
    int settle_below(double slow, int most);
    [[nodiscard]] bool is_finite() const;

    /// start(), then simulates `seconds` under strong damping; returns the wall time [ms] per 1/90 s. Loads
    /// and displacements grow over the first half second. Stops early if the body diverges.
    double settle(double seconds);

    /// Displacement [m] of a point of the unloaded block, trilinear in its cell.
    [[nodiscard]] Vec3d displacement_at(const Vec3d& rest) const;

  private:
    void substep(float dt, double share);
    void project(float dt);

    struct Held {
        std::size_t particle;
        std::function<Vec3d(double)> path;
    };

    BodySettings setting_;
    test::TetrahedralLattice lattice_;
    pbd::Particles particles_;
    double density_ = particle_density;
    std::vector<double> mass_, volume_;
    std::vector<Held> held_;
    pbd::ShapeMatching shapes_;
    pbd::ImplicitMesh implicit_;
    test::MassSprings springs_;
};

}  // namespace eti::bench
