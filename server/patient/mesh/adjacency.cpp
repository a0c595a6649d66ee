// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/mesh/adjacency.hpp"

#include <algorithm>

namespace eti {

Adjacency::Adjacency(const TriangleMesh& mesh) : first_(mesh.vertices.size() + 1, 0) {
    // On a closed, oriented mesh each neighbour follows the vertex in exactly one triangle.
    for (const Triangle& t : mesh.triangles) {
        for (const std::uint32_t v : t) {
            ++first_[v + 1];
        }
    }
    for (std::size_t v = 1; v < first_.size(); ++v) {
        first_[v] += first_[v - 1];
    }
    neighbour_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            neighbour_[next[t[k]]++] = t[(k + 1) % 3];
        }
    }
}

std::vector<std::uint8_t> Adjacency::dilated(const std::vector<std::uint8_t>& marked) const {
    std::vector<std::uint8_t> wide = marked;
    for (std::size_t v = 0; v < marked.size(); ++v) {
        if (std::ranges::any_of(of(v), [&](std::uint32_t to) { return marked[to] != 0; })) {
            wide[v] = 1;
        }
    }
    return wide;
}

}  // namespace eti
