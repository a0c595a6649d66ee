// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/implicit/relaxation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include "server/pbd/implicit/relaxation_kernels.hpp"

namespace eti::pbd {

namespace {

/// Calls body(metric at rest, index) for the elements' blocks, tetrahedra first.
template <class Body>
void for_blocks(const Tetrahedra& tetrahedra, const Hexahedra& hexahedra, const Body& body) {
    std::size_t n = 0;
    for (const Tetrahedra::Block& block : tetrahedra.blocks()) {
        body(block.metric, n++);
    }
    for (const Hexahedra::Block& block : hexahedra.blocks()) {
        body(block.metric, n++);
    }
}

}  // namespace

float Relaxation::rate(float dt, bool recovers) const {
    constexpr float recovery_time = 0.05f;  // [s]; half a second leaves 5e-5 of a memory
    return -std::expm1(-dt / (recovers ? recovery_time : time));
}

void RelaxationMemory::configure(const Relaxation& relaxation, const Tetrahedra& tetrahedra,
                                 const Hexahedra& hexahedra) {
    assert(relaxation.share >= 0.0f && relaxation.share < 1.0f && relaxation.time > 0.0f);
    relaxation_ = relaxation;
    tetrahedra_ = tetrahedra.blocks().size();
    metric_.resize(enabled() ? tetrahedra_ + hexahedra.blocks().size() : 0);
    old_.resize(metric_.size());
    reset(tetrahedra, hexahedra);
}

void RelaxationMemory::reset(const Tetrahedra& tetrahedra, const Hexahedra& hexahedra) {
    recovers_ = false;
    if (enabled()) {
        for_blocks(tetrahedra, hexahedra, [&](const auto& metric, std::size_t n) {
            static_assert(sizeof metric == sizeof metric_[n].metric);
            std::memcpy(metric_[n].metric, metric, sizeof metric);
        });
    }
}

RelaxationStep RelaxationMemory::step(float dt) const {
    return {.share = relaxation_.share, .rate = relaxation_.rate(dt, recovers_), .recovers = recovers_};
}

void RelaxationMemory::begin_rest(const Tetrahedra& tetrahedra, const Hexahedra& hexahedra) {
    if (enabled()) {
        for_blocks(tetrahedra, hexahedra, [&](const auto& metric, std::size_t n) {
            std::memcpy(old_[n].metric, metric, sizeof metric);
        });
    }
}

void RelaxationMemory::end_rest(const Tetrahedra& tetrahedra, const Hexahedra& hexahedra) {
    if (enabled()) {
        for_blocks(tetrahedra, hexahedra, [&](const auto& metric, std::size_t n) {
            Lanes before[6];
            Lanes after[6];
            for (int k = 0; k < 6; ++k) {
                load(old_[n].metric[k], before[k]);
                load(metric[k], after[k]);
            }
            carry(before, after, metric_[n]);
        });
    }
}

}  // namespace eti::pbd
