// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/triangle_mesh.hpp"

namespace eti {

/// Which vertices an edge joins to each vertex of a closed, oriented mesh.
class Adjacency {
  public:
    explicit Adjacency(const TriangleMesh& mesh);

    /// Each neighbour once.
    [[nodiscard]] std::span<const std::uint32_t> of(std::size_t vertex) const {
        return {neighbour_.data() + first_[vertex], first_[vertex + 1] - first_[vertex]};
    }
    /// Where those of a vertex begin in a list of all of them.
    [[nodiscard]] std::uint32_t first(std::size_t vertex) const { return first_[vertex]; }
    [[nodiscard]] std::size_t vertices() const { return first_.size() - 1; }
    /// Marks what an edge joins to a marked vertex, too.
    [[nodiscard]] std::vector<std::uint8_t> widened(const std::vector<std::uint8_t>& marked) const;

  private:
    std::vector<std::uint32_t> first_;      // by vertex, and one past the last
    std::vector<std::uint32_t> neighbour_;  // of all vertices
};

}  // namespace eti
