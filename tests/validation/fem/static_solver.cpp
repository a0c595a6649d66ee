// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/validation/fem/static_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace eti::fem {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::VectorXd;
using Matrix9d = Eigen::Matrix<double, 9, 9>;
using Matrix12d = Eigen::Matrix<double, 12, 12>;

constexpr int solver_iteration_limit = 200;
// Rounding of forces leaves about 1e-13 of the largest element force on meshes of thousands of elements.
constexpr double residual_limit = 1e-10;
// Lower bound for eigenvalues, relative to the shear modulus: enough for a factorisation in double.
constexpr double smallest_curvature = 1e-6;

Matrix3d cofactor(const Matrix3d& f) {
    Matrix3d out;
    out << f.col(1).cross(f.col(2)), f.col(2).cross(f.col(0)), f.col(0).cross(f.col(1));
    return out;
}

Matrix3d cross_matrix(const Vec3d& v) {
    Matrix3d out;
    out << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    return out;
}

VectorXd packed(const std::vector<Vec3d>& points) {
    VectorXd x(3 * static_cast<Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) {
        x.segment<3>(3 * static_cast<Index>(i)) = points[i];
    }
    return x;
}

Index first_of(std::uint32_t vertex) {
    return 3 * static_cast<Index>(vertex);
}

}  // namespace

Potential::Potential(const Problem& problem)
    : load_(VectorXd::Zero(3 * static_cast<Index>(problem.rest.size()))),
      mu_(problem.youngs_modulus / (2.0 * (1.0 + problem.poisson_ratio))) {
    obstacles_ = problem.obstacles;
    std::vector<bool> held(problem.rest.size(), false);
    for (const Problem::Held& h : problem.held) {
        held[h.vertex] = true;
    }
    for (std::uint32_t i = 0; i < held.size(); ++i) {
        if (!held[i]) {
            pushed_.push_back(first_of(i));
        }
    }
    // P = mu F + lambda (J - gamma) cof F is zero at F = 1 for gamma = 1 + mu / lambda, and its derivative
    // there is Hooke's with lambda - mu as Lamé's first parameter.
    lambda_ = mu_ + problem.youngs_modulus * problem.poisson_ratio /
                        ((1.0 + problem.poisson_ratio) * (1.0 - 2.0 * problem.poisson_ratio));
    gamma_ = 1.0 + mu_ / lambda_;
    for (std::size_t i = 0; i < problem.force.size(); ++i) {
        load_.segment<3>(3 * static_cast<Index>(i)) = problem.force[i];
    }
    for (const auto& corner : problem.tetrahedra) {
        Matrix3d edges;
        for (int v = 0; v < 3; ++v) {
            edges.col(v) = problem.rest[corner[static_cast<std::size_t>(v) + 1]] - problem.rest[corner[0]];
        }
        Element element{corner, {}, std::fabs(edges.determinant()) / 6.0};
        element.slope.bottomRows<3>() = edges.inverse();
        element.slope.row(0) = -element.slope.bottomRows<3>().colwise().sum();
        elements_.push_back(element);
        for (const std::uint32_t i : corner) {
            load_.segment<3>(first_of(i)) += 0.25 * problem.density * element.volume * problem.gravity;
        }
    }
}

Matrix3d Potential::deformation(const Element& element, const VectorXd& x) {
    Matrix3d f = Matrix3d::Zero();
    for (int v = 0; v < 4; ++v) {
        f += x.segment<3>(first_of(element.corner[static_cast<std::size_t>(v)])) * element.slope.row(v);
    }
    return f;
}

Potential::Depth Potential::depth_in(const Problem::Obstacle& obstacle, const Vec3d& x) {
    const Vec3d along = obstacle.b - obstacle.a;
    const double share = (x - obstacle.a).dot(along) / along.squaredNorm();
    const bool between = share > 0.0 && share < 1.0;
    const Vec3d away = x - obstacle.a - std::clamp(share, 0.0, 1.0) * along;
    const double distance = std::max(away.norm(), 1e-12);
    return {obstacle.radius - distance, distance, away / distance,
            between ? Vec3d(along.normalized()) : Vec3d(Vec3d::Zero())};
}

Vec3d Potential::force_on_obstacles(const VectorXd& x) const {
    Vec3d sum = Vec3d::Zero();
    for (const Problem::Obstacle& obstacle : obstacles_) {
        for (const Index i : pushed_) {
            const Depth d = depth_in(obstacle, x.segment<3>(i));
            if (d.depth > 0.0) {
                sum -= obstacle.stiffness * d.depth * d.out;
            }
        }
    }
    return sum;
}

Matrix3d Potential::stress(const Matrix3d& f) const {
    return mu_ * f + lambda_ * (f.determinant() - gamma_) * cofactor(f);
}

double Potential::energy(const VectorXd& x) const {
    double sum = -load_.dot(x);
    for (const Element& element : elements_) {
        const Matrix3d f = deformation(element, x);
        const double bulge = f.determinant() - gamma_;
        sum += element.volume * 0.5 * (mu_ * (f.squaredNorm() - 3.0) + lambda_ * bulge * bulge);
    }
    for (const Problem::Obstacle& obstacle : obstacles_) {
        for (const Index i : pushed_) {
            const double depth = std::max(0.0, depth_in(obstacle, x.segment<3>(i)).depth);
            sum += 0.5 * obstacle.stiffness * depth * depth;
        }
    }
    return sum;
}

VectorXd Potential::gradient(const VectorXd& x) const {
    VectorXd out = -load_;
    for (const Element& element : elements_) {
        const Eigen::Matrix<double, 3, 4> force =
            element.volume * stress(deformation(element, x)) * element.slope.transpose();
        for (int v = 0; v < 4; ++v) {
            out.segment<3>(first_of(element.corner[static_cast<std::size_t>(v)])) += force.col(v);
        }
    }
    for (const Problem::Obstacle& obstacle : obstacles_) {
        for (const Index i : pushed_) {
            const Depth d = depth_in(obstacle, x.segment<3>(i));
            if (d.depth > 0.0) {
                out.segment<3>(i) -= obstacle.stiffness * d.depth * d.out;
            }
        }
    }
    return out;
}

double Potential::largest_element_force(const VectorXd& x) const {
    double largest = load_.cwiseAbs().maxCoeff();
    for (const Element& element : elements_) {
        // mu F and the rest of the stress cancel at rest; rounding is that of each term.
        const Matrix3d f = deformation(element, x);
        largest = std::max(
            largest, element.volume * mu_ * (f * element.slope.transpose()).colwise().norm().maxCoeff());
    }
    return largest;
}

Matrix12d Potential::stiffness(std::size_t which, const VectorXd& x, bool definite) const {
    const Element& element = elements_[which];
    const Matrix3d f = deformation(element, x);
    const Matrix3d cof = cofactor(f);
    const Eigen::Matrix<double, 9, 1> g = cof.reshaped();
    Matrix9d by_f = mu_ * Matrix9d::Identity() + lambda_ * g * g.transpose();
    const double pressure = lambda_ * (f.determinant() - gamma_);
    for (int j = 0; j < 3; ++j) {
        // Column j of the cofactor is the product of columns j + 1 and j + 2 of F.
        const int a = (j + 1) % 3;
        const int b = (j + 2) % 3;
        by_f.block<3, 3>(3 * j, 3 * a) -= pressure * cross_matrix(f.col(b));
        by_f.block<3, 3>(3 * j, 3 * b) += pressure * cross_matrix(f.col(a));
    }
    const double smallest = smallest_curvature * mu_;
    // Most are definite, which a factorisation detects at a tenth of the cost.
    if (definite && Eigen::LLT<Matrix9d>(by_f - smallest * Matrix9d::Identity()).info() != Eigen::Success) {
        const Eigen::SelfAdjointEigenSolver<Matrix9d> eigen(by_f);
        by_f = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(smallest).asDiagonal() *
               eigen.eigenvectors().transpose();
    }
    Eigen::Matrix<double, 9, 12> b = Eigen::Matrix<double, 9, 12>::Zero();
    for (int v = 0; v < 4; ++v) {
        for (int j = 0; j < 3; ++j) {
            b.block<3, 3>(3 * j, 3 * v) = element.slope(v, j) * Matrix3d::Identity();
        }
    }
    return element.volume * b.transpose() * by_f * b;
}

Eigen::SparseMatrix<double> Potential::hessian(const VectorXd& x, bool definite) const {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(144 * elements_.size());
    for (std::size_t e = 0; e < elements_.size(); ++e) {
        const auto& corner = elements_[e].corner;
        const Matrix12d k = stiffness(e, x, definite);
        for (int c = 0; c < 12; ++c) {
            for (int r = 0; r < 12; ++r) {
                entries.emplace_back(first_of(corner[static_cast<std::size_t>(r / 3)]) + r % 3,
                                     first_of(corner[static_cast<std::size_t>(c / 3)]) + c % 3, k(r, c));
            }
        }
    }
    for (const Problem::Obstacle& obstacle : obstacles_) {
        for (const Index i : pushed_) {
            const Depth d = depth_in(obstacle, x.segment<3>(i));
            if (d.depth <= 0.0) {
                continue;
            }
            Matrix3d k = d.out * d.out.transpose();
            if (!definite) {  // the term from rotating the normal is never positive
                k -= d.depth / d.distance *
                     (Matrix3d::Identity() - d.out * d.out.transpose() - d.axis * d.axis.transpose());
            }
            for (int c = 0; c < 3; ++c) {
                for (int r = 0; r < 3; ++r) {
                    entries.emplace_back(i + r, i + c, obstacle.stiffness * k(r, c));
                }
            }
        }
    }
    Eigen::SparseMatrix<double> out(x.size(), x.size());
    out.setFromTriplets(entries.begin(), entries.end());
    return out;
}

namespace {

/// Rows and columns of the free coordinates.
Eigen::SparseMatrix<double> free_part(const Eigen::SparseMatrix<double>& full,
                                      const std::vector<Index>& place, Index count) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(full.nonZeros()));
    for (Index c = 0; c < full.outerSize(); ++c) {
        for (Eigen::SparseMatrix<double>::InnerIterator it(full, c); it; ++it) {
            const Index row = place[static_cast<std::size_t>(it.row())];
            const Index column = place[static_cast<std::size_t>(c)];
            if (row >= 0 && column >= 0) {
                entries.emplace_back(row, column, it.value());
            }
        }
    }
    Eigen::SparseMatrix<double> out(count, count);
    out.setFromTriplets(entries.begin(), entries.end());
    return out;
}

}  // namespace

Solution solve(const Problem& problem, const std::vector<Vec3d>& start) {
    const Potential potential(problem);
    VectorXd x = packed(start.empty() ? problem.rest : start);
    std::vector<Index> place(static_cast<std::size_t>(x.size()), 0);  // -1: held
    for (const Problem::Held& held : problem.held) {
        const Index i = first_of(held.vertex) + held.axis;
        x[i] = problem.rest[held.vertex][held.axis] + held.displacement;
        place[static_cast<std::size_t>(i)] = -1;
    }
    std::vector<Index> free;
    for (std::size_t i = 0; i < place.size(); ++i) {
        if (place[i] == 0) {
            place[i] = static_cast<Index>(free.size());
            free.push_back(static_cast<Index>(i));
        }
    }
    const auto count = static_cast<Index>(free.size());

    Solution out;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor;
    bool analysed = false;
    for (; out.iterations < solver_iteration_limit; ++out.iterations) {
        const VectorXd residual = potential.gradient(x)(free);
        out.residual = residual.cwiseAbs().maxCoeff() / potential.largest_element_force(x);
        out.converged = out.residual < residual_limit;
        if (out.converged) {
            break;
        }
        const auto factorised = [&](bool definite) {
            const Eigen::SparseMatrix<double> k = free_part(potential.hessian(x, definite), place, count);
            if (!analysed) {
                factor.analyzePattern(k);
                analysed = true;
            }
            factor.factorize(k);
            return factor.info() == Eigen::Success && factor.vectorD().minCoeff() > 0.0;
        };
        if (!factorised(false) && !factorised(true)) {
            break;
        }
        const VectorXd step = factor.solve(-residual);
        const double slope = residual.dot(step);
        const double energy = potential.energy(x);
        double length = 1.0;
        for (; length > 1e-10; length *= 0.5) {
            VectorXd tried = x;
            tried(free) += length * step;
            // Armijo's rule, down to the rounding of the energy; below that the residual decides.
            if (potential.energy(tried) <= energy + 1e-4 * length * slope + 1e-13 * std::fabs(energy)) {
                x = tried;
                break;
            }
        }
        if (length <= 1e-10) {
            break;
        }
    }
    for (std::size_t i = 0; i < problem.rest.size(); ++i) {
        out.position.push_back(x.segment<3>(3 * static_cast<Index>(i)));
    }
    return out;
}

}  // namespace eti::fem
