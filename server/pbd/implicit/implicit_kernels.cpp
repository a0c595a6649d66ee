// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/implicit/implicit_kernels.hpp"

namespace eti::pbd {

namespace {

using Element = ImplicitMesh::Element;
using HexahedronElement = ImplicitMesh::HexahedronElement;

bool linearise_baseline(const Tetrahedra::Block* blocks, Element* elements, std::size_t count,
                        const float* wide, const ImplicitSums& sums, float ratio, const RelaxationStep& step,
                        RelaxedMetric* memory) {
    return linearise_blocks(blocks, elements, count, wide, sums, ratio, step, memory);
}
bool linearise_baseline(const Hexahedra::Block* blocks, HexahedronElement* elements, std::size_t count,
                        const float* wide, const ImplicitSums& sums, float ratio, float hardening,
                        const RelaxationStep& step, RelaxedMetric* memory) {
    return linearise_hexahedra(blocks, elements, count, wide, sums, ratio, hardening, step, memory);
}
void apply_baseline(const Tetrahedra::Block* blocks, const Element* elements, std::size_t count,
                    const float* from, float* to) {
    apply_blocks(blocks, elements, count, from, to);
}
void apply_baseline(const Hexahedra::Block* blocks, const HexahedronElement* elements, std::size_t count,
                    const float* from, float* to) {
    apply_hexahedra(blocks, elements, count, from, to);
}
#if defined(__x86_64__)
[[gnu::target("avx2")]] bool linearise_avx2(const Tetrahedra::Block* blocks, Element* elements,
                                            std::size_t count, const float* wide, const ImplicitSums& sums,
                                            float ratio, const RelaxationStep& step, RelaxedMetric* memory) {
    return linearise_blocks(blocks, elements, count, wide, sums, ratio, step, memory);
}
[[gnu::target("avx2")]] bool linearise_avx2(const Hexahedra::Block* blocks, HexahedronElement* elements,
                                            std::size_t count, const float* wide, const ImplicitSums& sums,
                                            float ratio, float hardening, const RelaxationStep& step,
                                            RelaxedMetric* memory) {
    return linearise_hexahedra(blocks, elements, count, wide, sums, ratio, hardening, step, memory);
}
[[gnu::target("avx2")]] void apply_avx2(const Tetrahedra::Block* blocks, const Element* elements,
                                        std::size_t count, const float* from, float* to) {
    apply_blocks(blocks, elements, count, from, to);
}
[[gnu::target("avx2")]] void apply_avx2(const Hexahedra::Block* blocks, const HexahedronElement* elements,
                                        std::size_t count, const float* from, float* to) {
    apply_hexahedra(blocks, elements, count, from, to);
}
#else
template <class... Arguments>
bool linearise_avx2(const Arguments&... arguments) {
    return linearise_baseline(arguments...);
}
template <class... Arguments>
void apply_avx2(const Arguments&... arguments) {
    apply_baseline(arguments...);
}
#endif

}  // namespace

bool linearise(bool avx2, const Tetrahedra::Block* blocks, Element* elements, std::size_t count,
               const float* wide, const ImplicitSums& sums, float ratio, const RelaxationStep& step,
               RelaxedMetric* memory) {
    return avx2 ? linearise_avx2(blocks, elements, count, wide, sums, ratio, step, memory)
                : linearise_baseline(blocks, elements, count, wide, sums, ratio, step, memory);
}

bool linearise(bool avx2, const Hexahedra::Block* blocks, HexahedronElement* elements, std::size_t count,
               const float* wide, const ImplicitSums& sums, float ratio, float hardening,
               const RelaxationStep& step, RelaxedMetric* memory) {
    return avx2 ? linearise_avx2(blocks, elements, count, wide, sums, ratio, hardening, step, memory)
                : linearise_baseline(blocks, elements, count, wide, sums, ratio, hardening, step, memory);
}

void apply(bool avx2, const Tetrahedra::Block* blocks, const Element* elements, std::size_t count,
           const float* from, float* to) {
    if (avx2) {
        apply_avx2(blocks, elements, count, from, to);
    } else {
        apply_baseline(blocks, elements, count, from, to);
    }
}

void apply(bool avx2, const Hexahedra::Block* blocks, const HexahedronElement* elements, std::size_t count,
           const float* from, float* to) {
    if (avx2) {
        apply_avx2(blocks, elements, count, from, to);
    } else {
        apply_baseline(blocks, elements, count, from, to);
    }
}

}  // namespace eti::pbd
