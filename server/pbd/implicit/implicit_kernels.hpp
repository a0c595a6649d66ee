// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/pbd/implicit/hexahedron_kernels.hpp"
#include "server/pbd/implicit/implicit_mesh.hpp"
#include "server/pbd/implicit/tetrahedron_kernels.hpp"

namespace eti::pbd {

// Kernels of ImplicitMesh, compiled for the baseline and for AVX2, with the same bits. Arguments:
// tetrahedron_kernels.hpp and hexahedron_kernels.hpp.

[[nodiscard]] bool linearise(bool avx2, const Tetrahedra::Block* blocks, ImplicitMesh::Element* elements,
                             std::size_t count, const float* wide, const ImplicitSums& sums, float ratio,
                             const RelaxationStep& step, RelaxedMetric* memory);
[[nodiscard]] bool linearise(bool avx2, const Hexahedra::Block* blocks,
                             ImplicitMesh::HexahedronElement* elements, std::size_t count, const float* wide,
                             const ImplicitSums& sums, float ratio, float hardening,
                             const RelaxationStep& step, RelaxedMetric* memory);
void apply(bool avx2, const Tetrahedra::Block* blocks, const ImplicitMesh::Element* elements,
           std::size_t count, const float* from, float* to);
void apply(bool avx2, const Hexahedra::Block* blocks, const ImplicitMesh::HexahedronElement* elements,
           std::size_t count, const float* from, float* to);

}  // namespace eti::pbd
