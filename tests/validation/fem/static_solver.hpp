// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <cstdint>
#include <vector>

#include "common/math/transform.hpp"

/// Reference finite elements for tests and charts: linear tetrahedra in double precision, not optimised for
/// speed.
namespace eti::fem {

/// A body of the energy per volume mu/2 (tr(F^T F) - 3) + lambda/2 (det F - gamma)^2: Smith, de Goes & Kim
/// 2018, "Stable neo-Hookean flesh simulation", without the logarithm, as Macklin &
/// Müller 2021 use it. Linearised at rest it is Hooke's law of Young's modulus and Poisson ratio.
struct Problem {
    struct Held {
        std::uint32_t vertex = 0;
        int axis = 0;
        double displacement = 0.0;  ///< [m]
    };
    /// A rigid capsule that pushes every free vertex inside it outwards, like a spring between vertex and
    /// surface.
    struct Obstacle {
        Vec3d a = Vec3d::Zero(), b = Vec3d::Zero();  ///< [m], ends of the axis
        double radius = 0.0;                         ///< [m]
        double stiffness = 0.0;                      ///< [N/m], per vertex
    };
    std::vector<Vec3d> rest;  ///< [m]
    std::vector<std::array<std::uint32_t, 4>> tetrahedra;
    double youngs_modulus = 5e3;  ///< [Pa]
    double poisson_ratio = 0.45;  ///< below 0.5
    double density = 1000.0;      ///< [kg/m^3]
    Vec3d gravity = Vec3d::Zero();
    std::vector<Vec3d> force;  ///< [N], per vertex; none where empty
    std::vector<Held> held;    ///< must rule out rigid motion
    std::vector<Obstacle> obstacles;

    void hold(std::uint32_t vertex, const Vec3d& displacement = Vec3d::Zero()) {
        for (int axis = 0; axis < 3; ++axis) {
            held.push_back({vertex, axis, displacement[axis]});
        }
    }
};

/// Potential energy of a problem and its derivatives, as functions of all coordinates x0 y0 z0 x1 ... [m].
class Potential {
  public:
    explicit Potential(const Problem& problem);

    [[nodiscard]] double energy(const Eigen::VectorXd& x) const;
    [[nodiscard]] Eigen::VectorXd gradient(const Eigen::VectorXd& x) const;
    /// With `definite`, negative eigenvalues of the elements are raised to just above zero: no longer the
    /// exact derivative, but a descent direction from anywhere (Teran et al. 2005).
    [[nodiscard]] Eigen::SparseMatrix<double> hessian(const Eigen::VectorXd& x, bool definite) const;
    /// Largest force of one element on one corner [N]; the scale for residuals.
    [[nodiscard]] double largest_element_force(const Eigen::VectorXd& x) const;

    [[nodiscard]] std::size_t elements() const { return elements_.size(); }
    [[nodiscard]] const std::array<std::uint32_t, 4>& corners(std::size_t element) const {
        return elements_[element].corner;
    }
    /// Contribution of one element to hessian(), by its corners' coordinates.
    [[nodiscard]] Eigen::Matrix<double, 12, 12> stiffness(std::size_t element, const Eigen::VectorXd& x,
                                                          bool definite) const;

    /// [N], of all vertices on the obstacles.
    [[nodiscard]] Vec3d force_on_obstacles(const Eigen::VectorXd& x) const;

  private:
    struct Element {
        std::array<std::uint32_t, 4> corner;
        Eigen::Matrix<double, 4, 3> slope;  // of the shape functions [1/m]
        double volume;
    };
    [[nodiscard]] static Eigen::Matrix3d deformation(const Element& element, const Eigen::VectorXd& x);
    [[nodiscard]] Eigen::Matrix3d stress(const Eigen::Matrix3d& f) const;

    /// Penetration of a point into an obstacle [m], not positive outside, and the outward direction.
    struct Depth {
        double depth;
        double distance;  ///< from the axis [m]
        Vec3d out;        ///< unit
        Vec3d axis;       ///< unit, zero at the rounded ends
    };
    [[nodiscard]] static Depth depth_in(const Problem::Obstacle& obstacle, const Vec3d& x);

    std::vector<Element> elements_;
    std::vector<Problem::Obstacle> obstacles_;
    std::vector<Eigen::Index> pushed_;  // first coordinates of the vertices that obstacles push
    Eigen::VectorXd load_;
    double mu_, lambda_, gamma_;
};

struct Solution {
    std::vector<Vec3d> position;
    int iterations = 0;
    double residual = 0.0;  ///< largest unbalanced force, relative to the largest element force
    bool converged = false;
};

/// Static equilibrium by Newton's method with line search, from the rest shape or from `start`.
[[nodiscard]] Solution solve(const Problem& problem, const std::vector<Vec3d>& start = {});

}  // namespace eti::fem
