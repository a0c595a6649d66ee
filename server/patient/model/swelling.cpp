// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/model/swelling.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/LU>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "server/patient/model/stiffness.hpp"
#include "server/patient/model/tetrahedra_of.hpp"

namespace eti::patient {

namespace {

// Growth makes room for itself and is not squeezed out at its attachments. With the solver's 0.45 the
// tongue's dorsum would rise twice as far as in a newborn built with a larger tongue; with 0 it rises
// equally.
constexpr double poisson_ratio = 0.0;
constexpr float modulus = 1e3f;     // [Pa], arbitrary
constexpr double tolerance = 1e-6;  // relative residual: far below single precision at the scale of a mouth
constexpr int fixed = -1;

struct System {
    std::vector<int> unknown;  // [particles]: its first unknown, or `fixed`
    std::vector<Eigen::Triplet<double>> stiffness;
    Eigen::VectorXd load;

    void add(std::uint32_t row, std::uint32_t column, const Eigen::Matrix3d& block) {
        if (unknown[row] == fixed || unknown[column] == fixed) {
            return;
        }
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                stiffness.emplace_back(unknown[row] + i, unknown[column] + j, block(i, j));
            }
        }
    }
};

/// A linear tetrahedron's stiffness, and the load of an isotropic unit strain (as in thermal expansion:
/// Zienkiewicz & Taylor, The Finite Element Method, ch. 6).
void add_tetrahedron(const Patient& patient, const std::array<std::uint32_t, 4>& corners, System& system) {
    Eigen::Matrix3d edges;
    const auto at = [&](int v) {
        return patient.particles.rest[corners[static_cast<std::size_t>(v)]].cast<double>().eval();
    };
    for (int v = 0; v < 3; ++v) {
        edges.col(v) = at(v + 1) - at(0);
    }
    const double volume = std::fabs(edges.determinant()) / 6.0;
    const Eigen::Matrix3d inverse = edges.inverse();
    Eigen::Matrix<double, 3, 4> gradient;  // of the shape functions
    gradient.rightCols<3>() = inverse.transpose();
    gradient.col(0) = -gradient.rightCols<3>().rowwise().sum();
    const double e = static_cast<double>(modulus);
    const double mu = e / (2.0 * (1.0 + poisson_ratio));
    const double lambda = e * poisson_ratio / ((1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio));
    for (int a = 0; a < 4; ++a) {
        const Vec3d ga = gradient.col(a);
        for (int b = 0; b < 4; ++b) {
            const Vec3d gb = gradient.col(b);
            const Eigen::Matrix3d block = volume * (lambda * ga * gb.transpose() + mu * gb * ga.transpose() +
                                                    mu * ga.dot(gb) * Eigen::Matrix3d::Identity());
            system.add(corners[static_cast<std::size_t>(a)], corners[static_cast<std::size_t>(b)], block);
        }
        if (const int row = system.unknown[corners[static_cast<std::size_t>(a)]]; row != fixed) {
            system.load.segment<3>(row) += volume * (3.0 * lambda + 2.0 * mu) * ga;
        }
    }
}

/// Particles of the tongue outside of all tetrahedra move with the others of their clusters.
void carry_along(const Patient& patient, const std::vector<bool>& solved, std::vector<Vec3f>& displacement) {
    const ClusterSet& clusters = patient.clusters;
    std::vector<Vec3f> sum(displacement.size(), Vec3f::Zero());
    std::vector<float> count(displacement.size(), 0.0f);
    for (std::size_t c = 0; c < clusters.size(); ++c) {
        for (const std::uint32_t i : clusters.members(c)) {
            for (const std::uint32_t k : clusters.members(c)) {
                if (!solved[i] && solved[k]) {
                    sum[i] += displacement[k];
                    count[i] += 1.0f;
                }
            }
        }
    }
    for (std::size_t i = 0; i < displacement.size(); ++i) {
        if (count[i] > 0.0f && patient.particles.tissue[i] == Tissue::tongue &&
            patient.particles.mass[i] > 0.0f) {
            displacement[i] = sum[i] / count[i];
        }
    }
}

}  // namespace

std::vector<Vec3f> tongue_swelling(const Patient& patient) {
    const ParticleSet& set = patient.particles;
    std::vector<std::array<std::uint32_t, 4>> tongue;
    std::vector<bool> held(set.size(), false);
    for (const std::uint32_t t : tetrahedra_of(Tissue::tongue, patient)) {
        tongue.push_back(patient.tetrahedra.corners[t]);
        for (const std::uint32_t i : tongue.back()) {
            held[i] = true;
        }
    }
    System system;
    system.unknown.assign(set.size(), fixed);
    int unknowns = 0;
    for (std::size_t i = 0; i < set.size(); ++i) {
        if (held[i] && set.mass[i] > 0.0f) {
            system.unknown[i] = unknowns;
            unknowns += 3;
        }
    }
    std::vector<Vec3f> displacement(set.size(), Vec3f::Zero());
    if (unknowns == 0) {
        return displacement;
    }
    system.load = Eigen::VectorXd::Zero(unknowns);
    for (const auto& corners : tongue) {
        add_tetrahedron(patient, corners, system);
    }
    // The floor of the mouth is fixed. The ligament does not hold the tongue, but hangs on it.
    for (std::uint32_t l = 0; l < patient.links.ends.size(); ++l) {
        const auto [a, b] = patient.links.ends[l];
        if (set.tissue[a] == Tissue::epiglottis || set.tissue[b] == Tissue::epiglottis) {
            continue;
        }
        const Vec3d along = (set.rest[b] - set.rest[a]).cast<double>().normalized();
        const Eigen::Matrix3d spring =
            static_cast<double>(link_stiffness(patient, l, modulus)) * along * along.transpose();
        system.add(a, a, spring);
        system.add(b, b, spring);
        system.add(a, b, -spring);
        system.add(b, a, -spring);
    }
    Eigen::SparseMatrix<double> stiffness(unknowns, unknowns);
    stiffness.setFromTriplets(system.stiffness.begin(), system.stiffness.end());
    Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver;
    solver.setTolerance(tolerance);
    solver.compute(stiffness);
    const Eigen::VectorXd solution = solver.solve(system.load);
    for (std::size_t i = 0; i < set.size(); ++i) {
        if (system.unknown[i] != fixed) {
            displacement[i] = solution.segment<3>(system.unknown[i]).cast<float>();
        }
    }
    carry_along(patient, held, displacement);
    return displacement;
}

}  // namespace eti::patient
