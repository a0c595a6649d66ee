// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/soft/hexahedra.hpp"

#include <Eigen/LU>
#include <cassert>
#include <cmath>
#include <numeric>

#include "server/pbd/soft/hexahedron_modes.hpp"

namespace eti::pbd {

void Hexahedra::configure(const Description& description, const Particles& particles,
                          const CornerNumbering& numbering) {
    assert(description.youngs_modulus.size() == description.hexahedra.size());
    assert(description.poisson_ratio >= 0.2f && description.poisson_ratio < 0.4995f);
    corners_ = description.hexahedra;
    poisson_ratio_ = description.poisson_ratio;
    place_.resize(corners_.size());
    volume_.assign(corners_.size(), 0.0f);
    shear_modulus_.assign(corners_.size(), 0.0f);
    const std::vector<std::uint32_t> order = spatial_order(corners_, particles.rest);
    fill_blocks(corners_, coloured(corners_, order, particles.size()), numbering,
                static_cast<std::uint32_t>(numbering.particles().size()), block_, first_block_,
                [&](std::uint32_t cell, std::uint32_t place) { place_[cell] = place; });
    set_rest(particles);
    set_youngs_modulus(description.youngs_modulus);
}

void Hexahedra::set_rest(const Particles& particles) {
    for (std::size_t cell = 0; cell < size(); ++cell) {
        set_rest_of(cell, particles);
    }
}

void Hexahedra::set_rest_of(std::size_t cell, const Particles& particles) {
    Block& block = block_[place_[cell] / lanes];
    const std::size_t lane = place_[cell] % lanes;
    const auto mode = [&](unsigned bits) {  // sum over corners with the mode's signs
        Vec3d sum = Vec3d::Zero();
        for (unsigned v = 0; v < 8; ++v) {
            sum += hexahedron_sign(bits, v) * particles.rest[corners_[cell][v]].cast<double>();
        }
        return sum;
    };
    Eigen::Matrix3d edges;
    for (unsigned axis = 0; axis < 3; ++axis) {
        edges.col(axis) = 0.25 * mode(1u << axis);
    }
    const double determinant = edges.determinant();
    const double size = edges.colwise().norm().maxCoeff();
    const bool flat = !(std::fabs(determinant) > 1e-6 * size * size * size);
    const Eigen::Matrix3d inverse =
        flat ? Eigen::Matrix3d(Eigen::Matrix3d::Zero()) : Eigen::Matrix3d(edges.inverse());
    const Eigen::Matrix3d metric = inverse * inverse.transpose();
    constexpr int row[6] = {0, 1, 2, 1, 0, 0};
    constexpr int column[6] = {0, 1, 2, 2, 2, 1};
    for (int k = 0; k < 6; ++k) {
        block.metric[k][lane] = static_cast<float>(metric(row[k], column[k]));
    }
    block.inverse_determinant[lane] = static_cast<float>(inverse.determinant());
    for (std::size_t a = 0; a < hourglass_modes.size(); ++a) {
        const Vec3d warp = inverse * (0.125 * mode(hourglass_modes[a]));
        for (int axis = 0; axis < 3; ++axis) {
            block.warp[a][axis][lane] = static_cast<float>(warp[axis]);
        }
    }
    volume_[cell] = flat ? 0.0f : static_cast<float>(std::fabs(determinant));
    block.stiffness[lane] = shear_modulus_[cell] * volume_[cell];
}

void Hexahedra::set_youngs_modulus(std::span<const float> moduli) {
    assert(moduli.size() == size());
    for (std::size_t cell = 0; cell < size(); ++cell) {
        shear_modulus_[cell] = moduli[cell] / (2.0f * (1.0f + poisson_ratio_));
        block_[place_[cell] / lanes].stiffness[place_[cell] % lanes] = shear_modulus_[cell] * volume_[cell];
    }
}

double Hexahedra::volume() const {
    return std::accumulate(volume_.begin(), volume_.end(), 0.0);
}

}  // namespace eti::pbd
