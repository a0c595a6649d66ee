// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/transform.hpp"

namespace eti::pbd {

// Order of a mesh's elements: along a space-filling curve, then by colour, so that it depends on rest
// positions and not on the order of particles or elements.

/// Indices of points along a Morton curve.
[[nodiscard]] std::vector<std::uint32_t> spatial_order(std::span<const Vec3d> points);

/// The same for elements, by their rest centroids.
template <std::size_t corners>
[[nodiscard]] std::vector<std::uint32_t> spatial_order(
    const std::vector<std::array<std::uint32_t, corners>>& elements, const std::vector<Vec3f>& rest) {
    std::vector<Vec3d> centroid(elements.size(), Vec3d::Zero());
    for (std::size_t e = 0; e < elements.size(); ++e) {
        for (const std::uint32_t i : elements[e]) {
            centroid[e] += rest[i].cast<double>() / static_cast<double>(corners);
        }
    }
    return spatial_order(centroid);
}

/// Greedy colouring: each element, in the given order, takes the first colour without its particles.
/// Returns elements by colour.
template <std::size_t corners>
[[nodiscard]] std::vector<std::vector<std::uint32_t>> coloured(
    const std::vector<std::array<std::uint32_t, corners>>& elements, std::span<const std::uint32_t> order,
    std::size_t particles) {
    std::vector<std::vector<std::uint32_t>> colours;
    std::vector<std::vector<std::uint32_t>> taken(particles);
    std::vector<std::uint32_t> last_refusal;  // by colour, the position in `order` plus one
    for (std::size_t k = 0; k < order.size(); ++k) {
        const auto mark = static_cast<std::uint32_t>(k + 1);
        for (const std::uint32_t i : elements[order[k]]) {
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
        for (const std::uint32_t i : elements[order[k]]) {
            taken[i].push_back(colour);
        }
    }
    return colours;
}

/// Numbers the particles of elements in the order of their first use.
class CornerNumbering {
  public:
    static constexpr std::uint32_t none = ~0u;

    explicit CornerNumbering(std::size_t particles) : corner_of_(particles, none) {}

    template <std::size_t corners>
    void add(const std::vector<std::array<std::uint32_t, corners>>& elements,
             std::span<const std::uint32_t> order) {
        for (const std::uint32_t e : order) {
            for (const std::uint32_t i : elements[e]) {
                assert(i < corner_of_.size());
                if (corner_of_[i] == none) {
                    corner_of_[i] = static_cast<std::uint32_t>(particles_.size());
                    particles_.push_back(i);
                }
            }
        }
    }
    [[nodiscard]] std::uint32_t operator[](std::uint32_t particle) const { return corner_of_[particle]; }
    /// [corners]: particle indices.
    [[nodiscard]] const std::vector<std::uint32_t>& particles() const { return particles_; }

  private:
    std::vector<std::uint32_t> corner_of_;  // [particles]
    std::vector<std::uint32_t> particles_;  // [corners]
};

/// Corner offsets of a block of `lanes` elements (four numbers a corner), in blocks by colour. Lanes that
/// fill up a colour's last block have corners of their own from `padding` on. Calls assign(block, lane,
/// element), element by element.
template <class Block, std::size_t corners, class Assign>
void fill_blocks(const std::vector<std::array<std::uint32_t, corners>>& elements,
                 const std::vector<std::vector<std::uint32_t>>& colours, const CornerNumbering& numbering,
                 std::uint32_t padding, std::vector<Block>& blocks, std::vector<std::uint32_t>& first_block,
                 const Assign& assign) {
    constexpr std::size_t lanes = sizeof(Block::corner[0]) / sizeof(Block::corner[0][0]);
    blocks.clear();
    first_block.assign(1, 0);
    for (const std::vector<std::uint32_t>& colour : colours) {
        const std::size_t first = blocks.size();
        blocks.resize(first + (colour.size() + lanes - 1) / lanes, Block{});
        for (std::size_t k = 0; k < lanes * (blocks.size() - first); ++k) {
            const std::size_t lane = k % lanes;
            for (std::uint32_t v = 0; v < corners; ++v) {
                blocks[first + k / lanes].corner[v][lane] =
                    4 * (k < colour.size() ? numbering[elements[colour[k]][v]]
                                           : padding + static_cast<std::uint32_t>(corners * lane) + v);
            }
            if (k < colour.size()) {
                assign(colour[k], static_cast<std::uint32_t>(lanes * first + k));
            }
        }
        first_block.push_back(static_cast<std::uint32_t>(blocks.size()));
    }
}

}  // namespace eti::pbd
