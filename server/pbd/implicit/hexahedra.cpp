// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/implicit/hexahedra.hpp"

#include <cassert>
#include <numeric>

#include "server/pbd/implicit/rest_shape.hpp"

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
    const RestShape shape(edges);
    shape.store(block, lane);
    for (std::size_t a = 0; a < hourglass_modes.size(); ++a) {
        const Vec3d warp = shape.inverse * (0.125 * mode(hourglass_modes[a]));
        for (int axis = 0; axis < 3; ++axis) {
            block.warp[a][axis][lane] = static_cast<float>(warp[axis]);
        }
    }
    volume_[cell] = static_cast<float>(shape.determinant);
    block.stiffness[lane] = shear_modulus_[cell] * volume_[cell];
}

void Hexahedra::set_youngs_modulus(std::span<const float> moduli) {
    assert(moduli.size() == size());
    for (std::size_t cell = 0; cell < size(); ++cell) {
        shear_modulus_[cell] = shear_modulus(moduli[cell], poisson_ratio_);
        block_[place_[cell] / lanes].stiffness[place_[cell] % lanes] = shear_modulus_[cell] * volume_[cell];
    }
}

double Hexahedra::volume() const {
    return std::accumulate(volume_.begin(), volume_.end(), 0.0);
}

}  // namespace eti::pbd
