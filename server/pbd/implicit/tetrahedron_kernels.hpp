// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/pbd/implicit/implicit_mesh.hpp"
#include "server/pbd/implicit/neo_hookean.hpp"
#include "server/pbd/implicit/relaxation_kernels.hpp"
#include "server/pbd/lanes.hpp"

namespace eti::pbd {

// Kernels of ImplicitMesh for eight elements at a time; equations: implicit_mesh.hpp.

/// Four numbers per corner, indexed as in Tetrahedra::Block.
struct ImplicitSums {
    float* gradient;  ///< [N]; fourth: isotropic part of the diagonal block [N/m]
    float* square;    ///< [N/m], xx yy zz of lambda V H H^T
    float* mixed;     ///< [N/m], yz zx xy of the same
};

/// Upper bound of the largest eigenvalue of C = F^T F: (I1 + 2 sqrt(I1^2 - 3 I2)) / 3, with F^T F similar to
/// D^T D Q Q^T. Exact where two eigenvalues are equal.
[[gnu::always_inline]] inline void largest_stretch_squared(const Lanes (&edge)[3][3], const Lanes (&m)[6],
                                                           const Lanes& trace, Lanes& out) {
    constexpr int at[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    Lanes dot[3][3];
    for (int u = 0; u < 3; ++u) {
        for (int v = u; v < 3; ++v) {
            dot[u][v] = edge[u][0] * edge[v][0] + edge[u][1] * edge[v][1] + edge[u][2] * edge[v][2];
            dot[v][u] = dot[u][v];
        }
    }
    Lanes c[3][3];
    for (int u = 0; u < 3; ++u) {
        for (int v = 0; v < 3; ++v) {
            c[u][v] = dot[u][0] * m[at[0][v]] + dot[u][1] * m[at[1][v]] + dot[u][2] * m[at[2][v]];
        }
    }
    // tr C^2 = I1^2 - 2 I2, so that I1^2 - 3 I2 = (3 tr C^2 - I1^2) / 2.
    const Lanes squares = c[0][0] * c[0][0] + c[1][1] * c[1][1] + c[2][2] * c[2][2] +
                          2.0f * (c[0][1] * c[1][0] + c[1][2] * c[2][1] + c[2][0] * c[0][2]);
    Lanes spread = 1.5f * squares - 0.5f * trace * trace;
    const Lanes none{};
    spread = spread > none ? spread : none;
    sqrt_in_place(spread);
    out = (trace + 2.0f * spread) * (1.0f / 3.0f);
}

/// The volumetric strain s and the shear stiffness that keep an element's matrix positive definite, from the
/// square of its largest stretch.
[[gnu::always_inline]] inline void clamp_tangent(const Lanes& strain, const Lanes& stretch_squared,
                                                 const Lanes& shear, Lanes& cut, Lanes& stiffened) {
    constexpr float below_one = 0.999f;  // fraction of what the largest stretch allows
    const Lanes none{};
    Lanes stretch = stretch_squared + 1e-6f;
    sqrt_in_place(stretch);
    const Lanes most = below_one / stretch;
    cut = strain < -most ? -most : strain;
    cut = cut > most ? most : cut;
    // Strongly compressed elements are stiffer in some directions than the clamped matrix, by up to this
    // factor. With less than half of it a step would overshoot by more than its length.
    stiffened = 0.6f * (1.0f + (strain < none ? -strain : strain) * stretch);
    stiffened = shear * (stiffened > 1.0f ? stiffened : none + 1.0f);
}

/// Linearises these elements at the positions `wide`, and adds their forces and diagonal blocks to `sums`.
/// `ratio`: mu / lambda. Advances their `memory` by a `step`, unless it is nullptr, and returns whether any
/// has yet to settle.
[[gnu::always_inline]] inline bool linearise_blocks(const Tetrahedra::Block* blocks,
                                                    ImplicitMesh::Element* elements, std::size_t count,
                                                    const float* wide, const ImplicitSums& sums, float ratio,
                                                    const RelaxationStep& step = {},
                                                    RelaxedMetric* memory = nullptr) {
    const Lanes none{};
    Lanes left = none;
    for (std::size_t n = 0; n < count; ++n) {
        const Tetrahedra::Block& b = blocks[n];
        ImplicitMesh::Element& e = elements[n];
        Lanes x[4][3];
        Lanes unused;
        for (int v = 0; v < 4; ++v) {
            gather(wide, b.corner[v], x[v], unused);
        }
        RestTetrahedron<Lanes> rest;
        for (int k = 0; k < 6; ++k) {
            load(b.metric[k], rest.metric[k]);
        }
        load(b.inverse_determinant, rest.inverse_determinant);
        Lanes shear;
        load(b.stiffness, shear);
        Lanes edge[3][3];
        for (int v = 0; v < 3; ++v) {
            for (int i = 0; i < 3; ++i) {
                edge[v][i] = x[v + 1][i] - x[0][i];
                store(edge[v][i], e.edge[v][i]);
            }
        }
        if (memory != nullptr) {
            Lanes gram[6];
            gram_of(edge, gram);
            relax(gram, rest.inverse_determinant, step, memory[n], rest.metric, left);
        }
        NeoHookean<Lanes> c;
        neo_hookean(x, rest, c);
        const Lanes strain = (c.determinant - 1.0f - ratio) / ratio;
        Lanes stretch;
        largest_stretch_squared(edge, rest.metric, c.trace, stretch);
        Lanes cut;
        Lanes stiffened;
        clamp_tangent(strain, stretch, shear, cut, stiffened);
        for (int k = 0; k < 6; ++k) {
            store(stiffened * rest.metric[k], e.metric[k]);
        }
        const Lanes bulk = shear * (1.0f / ratio);
        store(bulk * rest.inverse_determinant * rest.inverse_determinant, e.bulk);
        store(shear * cut * rest.inverse_determinant, e.pressure);
        const Lanes(&m)[6] = rest.metric;
        for (int v = 0; v < 4; ++v) {
            const Lanes(&h)[3] = c.hydrostatic[v];
            Lanes force[3];
            Lanes square[3];
            Lanes mixed[3];
            for (int i = 0; i < 3; ++i) {
                force[i] = shear * (c.deviatoric[v][i] + strain * h[i]);
                square[i] = bulk * h[i] * h[i];
                mixed[i] = bulk * h[(i + 1) % 3] * h[(i + 2) % 3];
            }
            const Lanes own = v == 0 ? m[0] + m[1] + m[2] + 2.0f * (m[3] + m[4] + m[5]) : m[v - 1];
            scatter_add(sums.gradient, b.corner[v], force, stiffened * own);
            scatter_add(sums.square, b.corner[v], square, none);
            scatter_add(sums.mixed, b.corner[v], mixed, none);
        }
    }
    return any_positive(left);
}

[[gnu::always_inline]] inline void add_cross(const Lanes (&a)[3], const Lanes (&b)[3], Lanes (&out)[3]) {
    for (int i = 0; i < 3; ++i) {
        out[i] += a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
    }
}

/// Adds K times `from`, over these elements, to `to`.
[[gnu::always_inline]] inline void apply_blocks(const Tetrahedra::Block* blocks,
                                                const ImplicitMesh::Element* elements, std::size_t count,
                                                const float* from, float* to) {
    const Lanes none{};
    for (std::size_t n = 0; n < count; ++n) {
        const Tetrahedra::Block& b = blocks[n];
        const ImplicitMesh::Element& e = elements[n];
        Lanes x[4][3];
        Lanes unused;
        for (int v = 0; v < 4; ++v) {
            gather(from, b.corner[v], x[v], unused);
        }
        Lanes p[3][3];
        Lanes d[3][3];
        for (int v = 0; v < 3; ++v) {
            for (int i = 0; i < 3; ++i) {
                p[v][i] = x[v + 1][i] - x[0][i];
                load(e.edge[v][i], d[v][i]);
            }
        }
        Lanes m[6];
        for (int k = 0; k < 6; ++k) {
            load(e.metric[k], m[k]);
        }
        Lanes bulk;
        Lanes pressure;
        load(e.bulk, bulk);
        load(e.pressure, pressure);
        Lanes cofactor[3][3] = {};
        Lanes y[4][3] = {};
        Lanes change{};
        for (int v = 0; v < 3; ++v) {
            const int u = (v + 1) % 3;
            const int w = (v + 2) % 3;
            add_cross(d[u], d[w], cofactor[v]);
            add_cross(p[u], d[w], y[v + 1]);
            add_cross(d[u], p[w], y[v + 1]);
            change += cofactor[v][0] * p[v][0] + cofactor[v][1] * p[v][1] + cofactor[v][2] * p[v][2];
        }
        change *= bulk;
        for (int i = 0; i < 3; ++i) {
            y[1][i] = pressure * y[1][i] + change * cofactor[0][i] +
                      (p[0][i] * m[0] + p[1][i] * m[5] + p[2][i] * m[4]);
            y[2][i] = pressure * y[2][i] + change * cofactor[1][i] +
                      (p[0][i] * m[5] + p[1][i] * m[1] + p[2][i] * m[3]);
            y[3][i] = pressure * y[3][i] + change * cofactor[2][i] +
                      (p[0][i] * m[4] + p[1][i] * m[3] + p[2][i] * m[2]);
            y[0][i] = -(y[1][i] + y[2][i] + y[3][i]);
        }
        for (int v = 0; v < 4; ++v) {
            scatter_add(to, b.corner[v], y[v], none);
        }
    }
}

}  // namespace eti::pbd
