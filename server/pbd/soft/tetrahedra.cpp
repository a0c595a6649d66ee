// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/soft/tetrahedra.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "server/pbd/lanes.hpp"

namespace eti::pbd {

namespace {

constexpr std::uint32_t unnumbered = ~0u;

static_assert(lane_count == Tetrahedra::lanes);

using Corners = std::array<std::uint32_t, 4>;

float shear_modulus(float youngs_modulus, float poisson_ratio) {
    return youngs_modulus / (2.0f * (1.0f + poisson_ratio));
}

// Spreads 20 bits to every third bit of a Morton code.
std::uint64_t spread(std::uint64_t bits) {
    bits = (bits | bits << 32) & 0x1f00000000ffffULL;
    bits = (bits | bits << 16) & 0x1f0000ff0000ffULL;
    bits = (bits | bits << 8) & 0x100f00f00f00f00fULL;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3ULL;
    return (bits | bits << 2) & 0x1249249249249249ULL;
}

// Order of tetrahedra along a Morton curve through their rest centroids.
std::vector<std::uint32_t> spatial_order(const std::vector<Corners>& tetrahedra,
                                         const std::vector<Vec3f>& rest) {
    std::vector<Vec3d> centroid(tetrahedra.size(), Vec3d::Zero());
    Vec3d low = Vec3d::Constant(std::numeric_limits<double>::max());
    Vec3d high = -low;
    for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
        for (const std::uint32_t i : tetrahedra[t]) {
            centroid[t] += 0.25 * rest[i].cast<double>();
        }
        low = low.cwiseMin(centroid[t]);
        high = high.cwiseMax(centroid[t]);
    }
    const double scale = 0xfffff / std::max((high - low).maxCoeff(), 1e-12);
    std::vector<std::uint64_t> key(tetrahedra.size());
    for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
        const Vec3d at = scale * (centroid[t] - low);
        key[t] = spread(static_cast<std::uint64_t>(at.x())) |
                 spread(static_cast<std::uint64_t>(at.y())) << 1 |
                 spread(static_cast<std::uint64_t>(at.z())) << 2;
    }
    std::vector<std::uint32_t> order(tetrahedra.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return key[a] != key[b] ? key[a] < key[b] : a < b; });
    return order;
}

// Greedy colouring: each tetrahedron, in the given order, takes the first colour without its particles.
std::vector<std::vector<std::uint32_t>> coloured(const std::vector<Corners>& tetrahedra,
                                                 const std::vector<std::uint32_t>& order,
                                                 std::size_t particles) {
    std::vector<std::vector<std::uint32_t>> colours;
    std::vector<std::vector<std::uint32_t>> taken(particles);
    std::vector<std::uint32_t> last_refusal;  // by colour, the position in `order` plus one
    for (std::size_t k = 0; k < order.size(); ++k) {
        const auto mark = static_cast<std::uint32_t>(k + 1);
        for (const std::uint32_t i : tetrahedra[order[k]]) {
            for (const std::uint32_t colour : taken[i]) {
                last_refusal[colour] = mark;
            }
        }
        const auto free = std::find_if(last_refusal.begin(), last_refusal.end(),
                                       [&](auto refusal) { return refusal != mark; });
        const auto colour = static_cast<std::uint32_t>(free - last_refusal.begin());
        if (colour == colours.size()) {
            colours.emplace_back();
            last_refusal.push_back(0);
        }
        colours[colour].push_back(order[k]);
        for (const std::uint32_t i : tetrahedra[order[k]]) {
            taken[i].push_back(colour);
        }
    }
    return colours;
}

}  // namespace

void Tetrahedra::configure(const Description& description, const Particles& particles) {
    const std::vector<Corners>& tetrahedra = description.tetrahedra;
    assert(description.youngs_modulus.size() == tetrahedra.size());
    assert(description.poisson_ratio >= 0.2f && description.poisson_ratio < 0.4995f);
    poisson_ratio_ = description.poisson_ratio;
    shear_modulus_.resize(tetrahedra.size());
    volume_.assign(tetrahedra.size(), 0.0f);
    for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
        shear_modulus_[t] = shear_modulus(description.youngs_modulus[t], poisson_ratio_);
    }

    const std::vector<std::uint32_t> order = spatial_order(tetrahedra, particles.rest);
    std::vector<std::uint32_t> corner_of(particles.size(), unnumbered);
    used_.clear();
    for (const std::uint32_t t : order) {
        for (const std::uint32_t i : tetrahedra[t]) {
            assert(i < particles.size());
            if (corner_of[i] == unnumbered) {
                corner_of[i] = static_cast<std::uint32_t>(used_.size());
                used_.push_back(i);
            }
        }
    }
    // Padding lanes of a colour's last block have corners of their own, which no other lane writes.
    const auto filling = static_cast<std::uint32_t>(used_.size());

    place_.resize(tetrahedra.size());
    block_.clear();
    first_block_.assign(1, 0);
    for (const std::vector<std::uint32_t>& colour : coloured(tetrahedra, order, particles.size())) {
        const std::size_t first = block_.size();
        block_.resize(first + (colour.size() + lanes - 1) / lanes, Block{});
        for (std::size_t k = 0; k < lanes * (block_.size() - first); ++k) {
            Block& block = block_[first + k / lanes];
            const std::size_t lane = k % lanes;
            if (k < colour.size()) {
                place_[colour[k]] = static_cast<std::uint32_t>(lanes * first + k);
            }
            for (std::uint32_t v = 0; v < 4; ++v) {
                block.corner[v][lane] =
                    4 * (k < colour.size() ? corner_of[tetrahedra[colour[k]][v]]
                                           : filling + 4 * static_cast<std::uint32_t>(lane) + v);
            }
        }
        first_block_.push_back(static_cast<std::uint32_t>(block_.size()));
    }
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
    const double determinant = edges.determinant();
    const double size = edges.colwise().norm().maxCoeff();
    // A height of a millionth of the edge is the rounding error of coordinates ten edges from the origin.
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
    volume_[t] = flat ? 0.0f : static_cast<float>(std::fabs(determinant) / 6.0);
    block.stiffness[lane] = shear_modulus_[t] * volume_[t];
}

void Tetrahedra::set_youngs_modulus(std::span<const float> moduli) {
    assert(moduli.size() == place_.size());
    for (std::size_t t = 0; t < place_.size(); ++t) {
        shear_modulus_[t] = shear_modulus(moduli[t], poisson_ratio_);
        block_[place_[t] / lanes].stiffness[place_[t] % lanes] = shear_modulus_[t] * volume_[t];
    }
}

}  // namespace eti::pbd
