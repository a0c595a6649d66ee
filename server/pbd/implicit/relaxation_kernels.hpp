// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <limits>

#include "server/pbd/implicit/relaxation.hpp"
#include "server/pbd/lanes.hpp"

namespace eti::pbd {

// Kernels of stress relaxation for eight elements at a time; equations: relaxation.hpp. Symmetric matrices
// are 11, 22, 33, 23, 13, 12.

/// Strongly squeezed elements keep the memory that they have: where tr A would exceed three times this.
inline constexpr float most_relaxed = 10.0f;
/// The same for J^2 outside of these.
inline constexpr float least_squared_volume = 0.05f, most_squared_volume = 8.0f;
/// Remaining change of A below which a branch counts as settled: over a tongue of 40 mm two micrometres.
inline constexpr float settled_change = 1e-4f;

/// Dot products of edges.
[[gnu::always_inline]] inline void gram_of(const Lanes (&edge)[3][3], Lanes (&out)[6]) {
    constexpr int row[6] = {0, 1, 2, 1, 0, 0};
    constexpr int column[6] = {0, 1, 2, 2, 2, 1};
    for (int k = 0; k < 6; ++k) {
        const Lanes(&a)[3] = edge[row[k]];
        const Lanes(&b)[3] = edge[column[k]];
        out[k] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    }
}

/// Adjugate and determinant of a symmetric matrix.
[[gnu::always_inline]] inline void adjugate(const Lanes (&g)[6], Lanes (&out)[6], Lanes& determinant) {
    out[0] = g[1] * g[2] - g[3] * g[3];
    out[1] = g[0] * g[2] - g[4] * g[4];
    out[2] = g[0] * g[1] - g[5] * g[5];
    out[3] = g[4] * g[5] - g[0] * g[3];
    out[4] = g[5] * g[3] - g[4] * g[1];
    out[5] = g[4] * g[3] - g[5] * g[2];
    determinant = g[0] * out[0] + g[5] * out[5] + g[4] * out[4];
}

/// q^(-1/3) for q between the bounds of a squared volume, to float precision. Square roots and Newton's
/// method give the same bits on every instruction set.
[[gnu::always_inline]] inline void inverse_cube_root(const Lanes& q, Lanes& out) {
    out = q;
    sqrt_in_place(out);
    sqrt_in_place(out);
    out = 1.0f / out;  // q^(-1/4): too small or too large by up to q^(1/12), a quarter
    for (int n = 0; n < 4; ++n) {
        out = out * (4.0f - q * out * out * out) * (1.0f / 3.0f);
    }
}

/// Advances the memory by a step towards the shape of these edges, whose Gram matrix is `gram`, and replaces
/// the metric at rest by that of the shear. `left` becomes positive in lanes that have not settled.
[[gnu::always_inline]] inline void relax(const Lanes (&gram)[6], const Lanes& inverse_determinant,
                                         const RelaxationStep& step, RelaxedMetric& memory,
                                         Lanes (&metric)[6], Lanes& left) {
    const Lanes none{};
    const Lanes trace = metric[0] + metric[1] + metric[2];
    Lanes target[6];
    Lanes rate = none + step.rate;
    if (step.recovers) {
        for (int k = 0; k < 6; ++k) {
            target[k] = metric[k];
        }
    } else {
        Lanes determinant;
        adjugate(gram, target, determinant);
        const Lanes squared_scale = inverse_determinant * inverse_determinant;
        const Lanes squared_volume = determinant * squared_scale;
        Lanes bounded = squared_volume > least_squared_volume ? squared_volume : none + least_squared_volume;
        bounded = bounded < most_squared_volume ? bounded : none + most_squared_volume;
        Lanes root;
        inverse_cube_root(bounded, root);
        const Lanes scale = squared_scale * root * root;
        for (Lanes& t : target) {
            t *= scale;
        }
        rate = squared_volume == bounded ? rate : none;
        rate = target[0] + target[1] + target[2] <= most_relaxed * trace ? rate : none;
    }
    Lanes largest = none;
    for (int k = 0; k < 6; ++k) {
        Lanes relaxed;
        load(memory.metric[k], relaxed);
        const Lanes change = target[k] - relaxed;
        relaxed += rate * change;
        store(relaxed, memory.metric[k]);
        metric[k] += step.share * (relaxed - metric[k]);
        const Lanes size = change < none ? -change : change;
        largest = size > largest ? size : largest;
    }
    largest -= (settled_change / 3.0f) * trace;
    largest = rate > none ? largest : none;
    left = largest > left ? largest : left;
}

[[nodiscard]] [[gnu::always_inline]] inline bool any_positive(const Lanes& of) {
    bool any = false;
    for (std::size_t l = 0; l < lane_count; ++l) {
        any = any || of[l] > 0.0f;
    }
    return any;
}

/// Lower triangular L of g = L L^T: 11, 22, 33, 32, 31, 21; not finite where g is not positive definite.
[[gnu::always_inline]] inline void factorise(const Lanes (&g)[6], Lanes (&out)[6]) {
    out[0] = g[0];
    sqrt_in_place(out[0]);
    out[5] = g[5] / out[0];
    out[4] = g[4] / out[0];
    out[1] = g[1] - out[5] * out[5];
    sqrt_in_place(out[1]);
    out[3] = (g[3] - out[4] * out[5]) / out[1];
    out[2] = g[2] - out[4] * out[4] - out[3] * out[3];
    sqrt_in_place(out[2]);
}

/// Carries a memory from one metric at rest to another: Mv = B Mv B^T with B = L_new L_old^-1, which is a
/// rotation of A where the rest shape turns.
[[gnu::always_inline]] inline void carry(const Lanes (&before)[6], const Lanes (&after)[6],
                                         RelaxedMetric& memory) {
    Lanes l[6];
    Lanes k[6];
    factorise(before, l);
    factorise(after, k);
    const Lanes i11 = 1.0f / l[0];
    const Lanes i22 = 1.0f / l[1];
    const Lanes i33 = 1.0f / l[2];
    const Lanes i21 = -l[5] * i11 * i22;
    const Lanes i32 = -l[3] * i22 * i33;
    const Lanes i31 = (l[5] * l[3] - l[4] * l[1]) * i11 * i22 * i33;
    const Lanes none{};
    const Lanes b[3][3] = {{k[0] * i11, none, none},
                           {k[5] * i11 + k[1] * i21, k[1] * i22, none},
                           {k[4] * i11 + k[3] * i21 + k[2] * i31, k[3] * i22 + k[2] * i32, k[2] * i33}};
    Lanes m[6];
    for (int n = 0; n < 6; ++n) {
        load(memory.metric[n], m[n]);
    }
    const Lanes full[3][3] = {{m[0], m[5], m[4]}, {m[5], m[1], m[3]}, {m[4], m[3], m[2]}};
    constexpr int row[6] = {0, 1, 2, 1, 0, 0};
    constexpr int column[6] = {0, 1, 2, 2, 2, 1};
    for (int n = 0; n < 6; ++n) {
        Lanes carried = none;
        for (int u = 0; u < 3; ++u) {
            for (int v = 0; v < 3; ++v) {
                carried += b[row[n]][u] * full[u][v] * b[column[n]][v];
            }
        }
        // Elements that are flat in either shape start at rest, as do lanes that pad a block.
        const Lanes size = carried < none ? -carried : carried;
        store(size < std::numeric_limits<float>::max() ? carried : after[n], memory.metric[n]);
    }
}

}  // namespace eti::pbd
