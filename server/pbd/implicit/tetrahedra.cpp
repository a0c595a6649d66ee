// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/implicit/tetrahedra.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "server/pbd/implicit/rest_shape.hpp"
#include "server/pbd/lanes.hpp"

namespace eti::pbd {

static_assert(lane_count == Tetrahedra::lanes);

void Tetrahedra::configure(const Description& description, const Particles& particles) {
    CornerNumbering numbering(particles.size());
    numbering.add(description.tetrahedra, spatial_order(description.tetrahedra, particles.rest));
    configure(description, particles, numbering);
}

void Tetrahedra::configure(const Description& description, const Particles& particles,
                           const CornerNumbering& numbering) {
    const auto& tetrahedra = description.tetrahedra;
    assert(description.youngs_modulus.size() == tetrahedra.size());
    assert(description.poisson_ratio >= 0.2f && description.poisson_ratio < 0.4995f);
    poisson_ratio_ = description.poisson_ratio;
    shear_modulus_.resize(tetrahedra.size());
    volume_.assign(tetrahedra.size(), 0.0f);
    for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
        shear_modulus_[t] = shear_modulus(description.youngs_modulus[t], poisson_ratio_);
    }
    used_ = numbering.particles();
    place_.resize(tetrahedra.size());
    const std::vector<std::uint32_t> order = spatial_order(tetrahedra, particles.rest);
    fill_blocks(tetrahedra, coloured(tetrahedra, order, particles.size()), numbering,
                static_cast<std::uint32_t>(used_.size()), block_, first_block_,
                [&](std::uint32_t t, std::uint32_t place) { place_[t] = place; });
    set_rest(particles);
}

void Tetrahedra::set_rest(const Particles& particles) {
    for (std::size_t t = 0; t < place_.size(); ++t) {
        set_rest_of(t, particles);
    }
}

void Tetrahedra::set_rest_of(std::size_t t, const Particles& particles) {
    Block& block = block_[place_[t] / lanes];
    const std::size_t lane = place_[t] % lanes;
    const auto at = [&](int v) -> const Vec3f& { return particles.rest[used_[block.corner[v][lane] / 4]]; };
    Eigen::Matrix3d edges;
    for (int v = 0; v < 3; ++v) {
        edges.col(v) = at(v + 1).cast<double>() - at(0).cast<double>();
    }
    const RestShape shape(edges);
    shape.store(block, lane);
    volume_[t] = static_cast<float>(shape.determinant / 6.0);
    block.stiffness[lane] = shear_modulus_[t] * volume_[t];
}

double Tetrahedra::volume() const {
    double volume = 0.0;
    for (const Block& block : block_) {
        for (const float inverse : block.inverse_determinant) {
            volume += inverse != 0.0f ? 1.0 / (6.0 * std::fabs(double{inverse})) : 0.0;
        }
    }
    return volume;
}

void Tetrahedra::set_youngs_modulus(std::span<const float> moduli) {
    assert(moduli.size() == place_.size());
    for (std::size_t t = 0; t < place_.size(); ++t) {
        shear_modulus_[t] = shear_modulus(moduli[t], poisson_ratio_);
        block_[place_[t] / lanes].stiffness[place_[t] % lanes] = shear_modulus_[t] * volume_[t];
    }
}

}  // namespace eti::pbd
