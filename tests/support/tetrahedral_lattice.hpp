// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/math/transform.hpp"

namespace eti::test {

/// A box of cubic cells, each cut into tetrahedra; one corner lies at the origin.
struct TetrahedralLattice {
    std::vector<Vec3d> position;  ///< [m]
    std::vector<std::array<std::uint32_t, 4>> tetrahedra;
    int nx = 0, ny = 0, nz = 0;  ///< cells
    double cell = 0;             ///< [m]

    [[nodiscard]] std::uint32_t index(int x, int y, int z) const {
        return static_cast<std::uint32_t>((z * (ny + 1) + y) * (nx + 1) + x);
    }
};

/// Six tetrahedra around a diagonal of each cell (Kuhn), which fit together without mirroring; all have
/// the same volume and positive orientation.
inline TetrahedralLattice tetrahedral_lattice(int nx, int ny, int nz, double cell) {
    TetrahedralLattice out{{}, {}, nx, ny, nz, cell};
    for (int z = 0; z <= nz; ++z) {
        for (int y = 0; y <= ny; ++y) {
            for (int x = 0; x <= nx; ++x) {
                out.position.push_back(cell * Vec3d(x, y, z));
            }
        }
    }
    // Each path along the edges from corner 000 to 111 is one tetrahedron; odd permutations are reversed.
    constexpr int path[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    for (int z = 0; z < nz; ++z) {
        for (int y = 0; y < ny; ++y) {
            for (int x = 0; x < nx; ++x) {
                for (int k = 0; k < 6; ++k) {
                    int at[3] = {x, y, z};
                    std::array<std::uint32_t, 4> corner{out.index(x, y, z), 0, 0, 0};
                    for (std::size_t step = 0; step < 3; ++step) {
                        ++at[path[k][step]];
                        corner[step + 1] = out.index(at[0], at[1], at[2]);
                    }
                    if (k >= 3) {
                        std::swap(corner[1], corner[2]);
                    }
                    out.tetrahedra.push_back(corner);
                }
            }
        }
    }
    return out;
}

/// Nodal forces of a uniform traction [Pa of the rest shape] on one end face along x; each triangle gives a
/// third to each corner.
inline std::vector<Vec3d> end_traction(const TetrahedralLattice& lattice, int x, const Vec3d& traction) {
    std::vector<Vec3d> force(lattice.position.size(), Vec3d::Zero());
    for (const auto& corner : lattice.tetrahedra) {
        std::vector<std::uint32_t> face;
        for (const std::uint32_t i : corner) {
            if (std::fabs(lattice.position[i].x() - x * lattice.cell) < 1e-6 * lattice.cell) {
                face.push_back(i);
            }
        }
        if (face.size() == 3) {
            for (const std::uint32_t i : face) {
                force[i] += traction * lattice.cell * lattice.cell / 6.0;
            }
        }
    }
    return force;
}

}  // namespace eti::test
