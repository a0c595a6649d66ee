// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/triangle_mesh.hpp"

namespace eti {

/// Vertex neighbours of a closed, oriented mesh.
class Adjacency {
  public:
    explicit Adjacency(const TriangleMesh& mesh);

    /// The neighbours of a vertex, without duplicates.
    [[nodiscard]] std::span<const std::uint32_t> of(std::size_t vertex) const {
        return {neighbour_.data() + first_[vertex], first_[vertex + 1] - first_[vertex]};
    }
    /// Offset of a vertex's neighbours in the list of all of them.
    [[nodiscard]] std::uint32_t first(std::size_t vertex) const { return first_[vertex]; }
    [[nodiscard]] std::size_t vertices() const { return first_.size() - 1; }
    /// The marked vertices and their neighbours.
    [[nodiscard]] std::vector<std::uint8_t> dilated(const std::vector<std::uint8_t>& marked) const;

  private:
    std::vector<std::uint32_t> first_;      // [vertices + 1]
    std::vector<std::uint32_t> neighbour_;  // of all vertices, concatenated
};

}  // namespace eti
