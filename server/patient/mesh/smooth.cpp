// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/mesh/smooth.hpp"

namespace eti {

void smooth(TriangleMesh& mesh, int iterations, float lambda, float mu) {
    const std::size_t count = mesh.vertices.size();
    // On a closed, oriented mesh each neighbour follows the vertex in exactly one triangle.
    std::vector<float> weight(count, 0.0f);
    for (const Triangle& t : mesh.triangles) {
        for (const std::uint32_t v : t) {
            weight[v] += 1.0f;
        }
    }
    for (float& w : weight) {
        w = w > 0.0f ? 1.0f / w : 0.0f;
    }
    std::vector<Vec3f> sum(count);
    for (int pass = 0; pass < 2 * iterations; ++pass) {
        const float step = pass % 2 == 0 ? lambda : mu;
        std::fill(sum.begin(), sum.end(), Vec3f::Zero());
        for (const Triangle& t : mesh.triangles) {
            for (std::size_t k = 0; k < 3; ++k) {
                sum[t[k]] += mesh.vertices[t[(k + 1) % 3]] - mesh.vertices[t[k]];
            }
        }
        for (std::size_t v = 0; v < count; ++v) {
            mesh.vertices[v] += step * weight[v] * sum[v];
        }
    }
}

}  // namespace eti
