// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Cholesky>
#include <array>
#include <cstddef>
#include <vector>

#include "server/pbd/lanes.hpp"

namespace eti::pbd {

/// Bodies that hold corners of an implicit mesh and yield under its reaction, in generalised coordinates q.
/// They are unknowns of the mesh's own step,
///     [ K_ff    K_fh J              ] [dx]   [residual of the free corners]
///     [ J^T K_hf  J^T K_hh J + matrix ] [dq] = [J^T residual of the held corners + force]
/// so that the coupling is stable for any ratio of stiffness and mass. Obstacles that they carry, the far
/// ends of the mesh's contacts, move with them within the step. Coordinates that are not used have a row and
/// column of the identity.
struct YieldingBodies {
    static constexpr std::size_t coordinates = 7;
    using Vector = Eigen::Matrix<float, coordinates, 1>;
    using Matrix = Eigen::Matrix<float, coordinates, coordinates>;
    /// Displacement of one corner per unit of each coordinate: a column of its Jacobian each.
    using Columns = std::array<Eigen::Vector4f, coordinates>;

    /// The bodies' own matrix in a step of dt: inertia / dt^2 + damping / dt + stiffness; symmetric, positive
    /// definite. Units are newton (or newton metre) per unit of the coordinates.
    Matrix matrix = Matrix::Identity();
    Vector force = Vector::Zero();  ///< generalised force at the beginning of the step
    std::vector<Columns> jacobian;  ///< [held corners], in the order of ImplicitMesh::held()
    std::vector<Columns> far_ends;  ///< Jacobians of contacts' far ends
    Vector step = Vector::Zero();   ///< result: increment of the coordinates
    [[nodiscard]] const Columns& far_end(std::int32_t number) const {
        return far_ends[static_cast<std::size_t>(number)];
    }
    /// Returns the number of a far end with these columns.
    [[nodiscard]] std::int32_t add_far_end(const Columns& columns) {
        far_ends.push_back(columns);
        return static_cast<std::int32_t>(far_ends.size()) - 1;
    }
    [[nodiscard]] bool yield() const { return !jacobian.empty() || !far_ends.empty(); }

    [[nodiscard]] static Float4 displacement(const Columns& columns, const Vector& of) {
        Float4 sum{};
        for (std::size_t c = 0; c < coordinates; ++c) {
            sum += of[static_cast<Eigen::Index>(c)] * load_float4(columns[c]);
        }
        return sum;
    }
    /// Adds J^T B J for a corner's symmetric block B: xx yy zz with the isotropic part, and yz zx xy.
    static void add_projected(const Columns& columns, const Eigen::Vector4f& square,
                              const Eigen::Vector4f& mixed, Matrix& to) {
        Eigen::Matrix3f block;
        block << square[0] + square[3], mixed[2], mixed[1], mixed[2], square[1] + square[3], mixed[0],
            mixed[1], mixed[0], square[2] + square[3];
        Eigen::Matrix<float, 3, coordinates> jacobian;
        for (std::size_t c = 0; c < coordinates; ++c) {
            jacobian.col(static_cast<Eigen::Index>(c)) = columns[c].head<3>();
        }
        to.noalias() += jacobian.transpose() * block * jacobian;
    }
    static void add_transposed(const Columns& columns, const Eigen::Vector4f& residual, Vector& to) {
        for (std::size_t c = 0; c < coordinates; ++c) {
            to[static_cast<Eigen::Index>(c)] += columns[c].head<3>().dot(residual.head<3>());
        }
    }
};

}  // namespace eti::pbd
