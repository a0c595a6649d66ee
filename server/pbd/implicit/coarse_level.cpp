// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/implicit/coarse_level.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace eti::pbd {

namespace {

constexpr double cells_filled = 5.0;  // lattice cells that the mesh fills, if fine enough: about sixty nodes
constexpr double min_cells = 3.0;     // mesh cells along a lattice cell
constexpr float min_width = 1e-6f;    // [m]; for a mesh without volume

}  // namespace

void CoarseLevel::configure(std::span<const Eigen::Vector4f> rest, std::span<const float> inverse_mass,
                            const Tetrahedra& tetrahedra, const Hexahedra& hexahedra, float cell,
                            float bulk_over_shear) {
    stiffness_ = 1.0f;
    const double cells = static_cast<double>(tetrahedra.size() + 6 * hexahedra.size()) / 6.0;
    const auto wider = static_cast<float>(std::max(std::cbrt(cells / cells_filled), min_cells));
    number_nodes(rest, inverse_mass, std::max(wider * cell, min_width));
    add_tetrahedra(tetrahedra, 1.0f + bulk_over_shear);
    add_hexahedra(hexahedra, 1.0f + bulk_over_shear);
    matrix_.setZero();
    for (std::uint32_t k = 0; k < inverse_mass.size(); ++k) {
        if (inverse_mass[k] > 0.0f) {
            add_spring(k, 1.0f / inverse_mass[k]);
        }
    }
    mass_ = matrix_;
}

void CoarseLevel::number_nodes(std::span<const Eigen::Vector4f> rest, std::span<const float> inverse_mass,
                               float width) {
    std::map<std::array<int, 3>, std::uint32_t> number;
    place_.assign(inverse_mass.size(), {});
    for (std::size_t k = 0; k < place_.size(); ++k) {
        if (inverse_mass[k] == 0.0f) {
            continue;
        }
        const Vec3f at = (rest[k] - rest[0]).head<3>() / width;
        const Vec3f base = at.array().floor();
        for (std::size_t n = 0; n < support; ++n) {
            std::array<int, 3> node{};
            float weight = 1.0f;
            for (int axis = 0; axis < 3; ++axis) {
                const bool upper = (n >> axis & 1u) != 0;
                const float part = at[axis] - base[axis];
                node[static_cast<std::size_t>(axis)] = static_cast<int>(base[axis]) + (upper ? 1 : 0);
                weight *= upper ? part : 1.0f - part;
            }
            place_[k].node[n] =
                number.try_emplace(node, static_cast<std::uint32_t>(number.size())).first->second;
            place_[k].weight[n] = weight;
        }
    }
    const auto nodes = static_cast<Eigen::Index>(number.size());
    elastic_.setZero(nodes, nodes);
    matrix_.setZero(nodes, nodes);
    motion_.setZero(nodes, 4);
    factor_.compute(Eigen::MatrixXf::Identity(nodes, nodes));  // allocates memory
}

void CoarseLevel::add_tetrahedra(const Tetrahedra& tetrahedra, float times) {
    for (std::size_t n = 0; n < tetrahedra.colours() * Tetrahedra::lanes; ++n) {
        const std::size_t lane = n % Tetrahedra::lanes;
        for (const Tetrahedra::Block& block : tetrahedra.blocks(n / Tetrahedra::lanes)) {
            if (block.inverse_determinant[lane] == 0.0f) {
                continue;  // flat, or padding only
            }
            const auto metric = [&](int row) {
                return times * block.stiffness[lane] * block.metric[row][lane];
            };
            Eigen::Matrix4f energy = Eigen::Matrix4f::Zero();
            energy.bottomRightCorner<3, 3>() << metric(0), metric(5), metric(4), metric(5), metric(1),
                metric(3), metric(4), metric(3), metric(2);
            energy.row(0) = -energy.colwise().sum();
            energy.col(0) = -energy.rowwise().sum();
            for (std::size_t k = 0; k < 16; ++k) {
                add_product(elastic_, place_[block.corner[k / 4][lane] / 4],
                            place_[block.corner[k % 4][lane] / 4],
                            energy(static_cast<Eigen::Index>(k / 4), static_cast<Eigen::Index>(k % 4)));
            }
        }
    }
}

void CoarseLevel::add_hexahedra(const Hexahedra& hexahedra, float times) {
    for (std::size_t n = 0; n < hexahedra.colours() * Hexahedra::lanes; ++n) {
        const std::size_t lane = n % Hexahedra::lanes;
        for (const Hexahedra::Block& block : hexahedra.blocks(n / Hexahedra::lanes)) {
            if (block.inverse_determinant[lane] == 0.0f) {
                continue;  // flat, or padding only
            }
            // Shear of the mean edges; hourglass modes are shorter than a lattice cell.
            for (unsigned v = 0; v < 8; ++v) {
                for (unsigned w = 0; w < 8; ++w) {
                    constexpr std::size_t at[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
                    float product = 0.0f;
                    for (std::size_t k = 0; k < 9; ++k) {
                        const auto row = static_cast<unsigned>(k / 3);
                        const auto column = static_cast<unsigned>(k % 3);
                        product += static_cast<float>(hexahedron_sign(1u << row, v) *
                                                      hexahedron_sign(1u << column, w)) *
                                   block.metric[at[row][column]][lane];
                    }
                    add_product(elastic_, place_[block.corner[v][lane] / 4],
                                place_[block.corner[w][lane] / 4],
                                times * block.stiffness[lane] * product / 16.0f);
                }
            }
        }
    }
}

void CoarseLevel::begin(float per_mass) {
    matrix_ = stiffness_ * elastic_ + per_mass * mass_;
}

void CoarseLevel::add_product(Eigen::MatrixXf& to, const Place& p, const Place& q, float times) {
    for (std::size_t j = 0; j < support; ++j) {
        float* const column = to.data() + std::size_t{q.node[j]} * size();
        const float part = times * q.weight[j];
        for (std::size_t i = 0; i < support; ++i) {
            column[p.node[i]] += part * p.weight[i];
        }
    }
}

void CoarseLevel::add_spring(std::uint32_t corner, float stiffness) {
    add_product(matrix_, place_[corner], place_[corner], stiffness);
}

void CoarseLevel::add_spring(std::span<const std::uint32_t> corners, std::span<const float> shares,
                             float stiffness) {
    if (corners.size() > 2) {
        add_joined(corners, shares, stiffness);
        return;
    }
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Place& p = place_[corners[i]];
        add_product(matrix_, p, p, stiffness * shares[i] * shares[i]);
        for (std::size_t k = i + 1; k < corners.size(); ++k) {
            const Place& q = place_[corners[k]];
            const float both = stiffness * shares[i] * shares[k];
            add_product(matrix_, p, q, both);
            add_product(matrix_, q, p, both);
        }
    }
}

void CoarseLevel::add_joined(std::span<const std::uint32_t> corners, std::span<const float> shares,
                             float stiffness) {
    // Corners of an element have most of their nodes in common.
    std::array<std::uint32_t, max_joined> node{};
    std::array<float, max_joined> weight{};
    std::size_t count = 0;
    for (std::size_t e = 0; e < corners.size(); ++e) {
        const Place& p = place_[corners[e]];
        for (std::size_t n = 0; n < support; ++n) {
            if (p.weight[n] == 0.0f) {
                continue;
            }
            std::size_t at = 0;
            while (at < count && node[at] != p.node[n]) {
                ++at;
            }
            if (at == count) {
                node[count] = p.node[n];
                weight[count++] = 0.0f;
            }
            weight[at] += shares[e] * p.weight[n];
        }
    }
    for (std::size_t j = 0; j < count; ++j) {
        float* const column = matrix_.data() + std::size_t{node[j]} * size();
        for (std::size_t i = 0; i < count; ++i) {
            column[node[i]] += stiffness * weight[j] * weight[i];
        }
    }
}

void CoarseLevel::factorise() {
    // Regularizes nodes with almost no corner.
    const float least = 1e-5f * (matrix_.rows() > 0 ? matrix_.diagonal().maxCoeff() : 0.0f);
    matrix_.diagonal().array() += least;
    factor_.compute(matrix_);
}

float CoarseLevel::solve(const Motion& force) {
    motion_ = force;
    factor_.solveInPlace(motion_);
    return motion_.cwiseProduct(force).leftCols<3>().sum();
}

}  // namespace eti::pbd
