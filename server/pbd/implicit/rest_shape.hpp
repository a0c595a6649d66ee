// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/LU>
#include <cmath>
#include <cstddef>

namespace eti::pbd {

/// What an element keeps of its edge vectors at rest.
struct RestShape {
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();  ///< Q, of the edges [1/m]; zero where they are flat
    double determinant = 0.0;                           ///< |det| of the edges [m^3]; 0 where they are flat

    explicit RestShape(const Eigen::Matrix3d& edges) {
        const double size = edges.colwise().norm().maxCoeff();
        const double signed_determinant = edges.determinant();
        // A height of a millionth of the edge is the rounding error of coordinates ten edges from the origin.
        if (std::fabs(signed_determinant) > 1e-6 * size * size * size) {
            inverse = edges.inverse();
            determinant = std::fabs(signed_determinant);
        }
    }

    /// Writes Q Q^T and det Q to one lane of a block; see RestTetrahedron.
    template <class Block>
    void store(Block& block, std::size_t lane) const {
        const Eigen::Matrix3d metric = inverse * inverse.transpose();
        constexpr int row[6] = {0, 1, 2, 1, 0, 0};
        constexpr int column[6] = {0, 1, 2, 2, 2, 1};
        for (int k = 0; k < 6; ++k) {
            block.metric[k][lane] = static_cast<float>(metric(row[k], column[k]));
        }
        block.inverse_determinant[lane] = static_cast<float>(inverse.determinant());
    }
};

[[nodiscard]] constexpr float shear_modulus(float youngs_modulus, float poisson_ratio) {
    return youngs_modulus / (2.0f * (1.0f + poisson_ratio));
}

}  // namespace eti::pbd
