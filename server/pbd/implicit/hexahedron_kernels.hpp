// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <limits>

#include "server/pbd/implicit/hexahedra.hpp"
#include "server/pbd/implicit/tetrahedron_kernels.hpp"
#include "server/pbd/lanes.hpp"

namespace eti::pbd {

// Kernels of ImplicitMesh for eight hexahedra at a time. With mean edges e, hourglass modes q (less the rest
// shape's warp), Q the inverse of the mean edges at rest, M = Q Q^T and [a b c] the triple product, a cell of
// volume V has the energy
//     mu V/2 (sum M_uv e_u.e_v - 3 + sum K_ab q_a.q_b)                        shear
//   + hardening mu V/4 (sum K_ab q_a.q_b)^2                                   of hourglass modes
//   + lambda V/2 (J - gamma)^2                                                volume
//   + kappa mu V/6 (Jx^2 + Jy^2 + Jz^2)                                       gradient of the volume.
// Shear is mu/2 (|F|^2 - 3) integrated exactly over a parallelepiped: K = 4/3 (M11 + M22), 4/3 (M11 + M33),
// 4/3 (M22 + M33), 4/9 tr M on the diagonal, 4/3 M23, M13, M12 beside it. J is the cell's exact volume ratio,
//     det Q ([e1 e2 e3] + 4/3 ([q12 q13 e1] + [q23 q12 e2] + [q13 q23 e3])).
// One volumetric term a cell does not lock near incompressibility. Jx, Jy, Jz are the slopes of the local
// volume ratio along the cell's axes, which bending changes and the mean J does not see.
// Not modelled: the warp's effect on Q within a cell.

/// Stiffness of the volume's gradient over mu: a plate one cell thick bends as it should.
inline constexpr float volume_gradient_stiffness = 1.2f;

struct HexahedronModes {
    Lanes edge[3][3];       ///< [axis][coordinate]
    Lanes hourglass[4][3];  ///< [mode, see hourglass_modes][coordinate]
};

[[gnu::always_inline]] inline void cross_to(const Lanes (&a)[3], const Lanes (&b)[3], Lanes (&out)[3]) {
    for (int i = 0; i < 3; ++i) {
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
    }
}
[[gnu::always_inline]] inline void add_scaled_cross(const Lanes& by, const Lanes (&a)[3], const Lanes (&b)[3],
                                                    Lanes (&out)[3]) {
    for (int i = 0; i < 3; ++i) {
        out[i] += by * (a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]);
    }
}
[[gnu::always_inline]] inline void add_dot(const Lanes (&a)[3], const Lanes (&b)[3], Lanes& out) {
    out += a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Hadamard transform of corner values to modes.
[[gnu::always_inline]] inline void corners_to_modes(Lanes (&a)[8]) {
    for (const int bit : {1, 2, 4}) {
        for (int i = 0; i < 8; ++i) {
            if ((i & bit) == 0) {
                const Lanes low = a[i];
                const Lanes high = a[i | bit];
                a[i] = low + high;
                a[i | bit] = high - low;
            }
        }
    }
}
/// Its transpose: forces on modes to forces on corners.
[[gnu::always_inline]] inline void modes_to_corners(Lanes (&a)[8]) {
    for (const int bit : {1, 2, 4}) {
        for (int i = 0; i < 8; ++i) {
            if ((i & bit) == 0) {
                const Lanes low = a[i];
                const Lanes high = a[i | bit];
                a[i] = low - high;
                a[i | bit] = low + high;
            }
        }
    }
}

[[gnu::always_inline]] inline void gather_corners(const float* from, const Hexahedra::Block& block,
                                                  Lanes (&x)[3][8]) {
    for (int v = 0; v < 8; ++v) {
        Lanes xyz[3];
        Lanes unused;
        gather(from, block.corner[v], xyz, unused);
        for (int i = 0; i < 3; ++i) {
            x[i][v] = xyz[i];
        }
    }
}

/// Changes the corner values `x`.
[[gnu::always_inline]] inline void modes_of(const Hexahedra::Block& block, Lanes (&x)[3][8],
                                            HexahedronModes& out) {
    for (int i = 0; i < 3; ++i) {
        corners_to_modes(x[i]);
        for (int u = 0; u < 3; ++u) {
            out.edge[u][i] = 0.25f * x[i][1 << u];
        }
        for (int a = 0; a < 4; ++a) {
            out.hourglass[a][i] = 0.125f * x[i][hourglass_modes[static_cast<std::size_t>(a)]];
        }
    }
    for (int a = 0; a < 4; ++a) {
        for (int u = 0; u < 3; ++u) {
            Lanes warp;
            load(block.warp[a][u], warp);
            for (int i = 0; i < 3; ++i) {
                out.hourglass[a][i] -= warp * out.edge[u][i];
            }
        }
    }
}

[[gnu::always_inline]] inline void gather_modes(const float* from, const Hexahedra::Block& block,
                                                HexahedronModes& out) {
    Lanes x[3][8];
    gather_corners(from, block, x);
    modes_of(block, x, out);
}

/// The smallest volume of the parallelepipeds that a corner's three edges span.
[[gnu::always_inline]] inline void smallest_corner_of(const Lanes (&x)[3][8], Lanes& out) {
    out = Lanes{} + std::numeric_limits<float>::max();
    for (int v = 0; v < 8; ++v) {
        Lanes edge[3][3];
        for (int b = 0; b < 3; ++b) {
            const int to = v ^ (1 << b);
            const float sign = to > v ? 1.0f : -1.0f;
            for (int i = 0; i < 3; ++i) {
                edge[b][i] = sign * (x[i][to] - x[i][v]);
            }
        }
        Lanes normal[3];
        cross_to(edge[1], edge[2], normal);
        Lanes volume{};
        add_dot(edge[0], normal, volume);
        out = volume < out ? volume : out;
    }
}

/// Transpose of gather_modes(): [coordinate][corner]. Changes `modes`.
[[gnu::always_inline]] inline void corners_of(const Hexahedra::Block& block, HexahedronModes& modes,
                                              Lanes (&x)[3][8]) {
    for (int a = 0; a < 4; ++a) {
        for (int u = 0; u < 3; ++u) {
            Lanes warp;
            load(block.warp[a][u], warp);
            for (int i = 0; i < 3; ++i) {
                modes.edge[u][i] -= warp * modes.hourglass[a][i];
            }
        }
    }
    for (int i = 0; i < 3; ++i) {
        x[i][0] = Lanes{};
        for (int u = 0; u < 3; ++u) {
            x[i][1 << u] = 0.25f * modes.edge[u][i];
        }
        for (int a = 0; a < 4; ++a) {
            x[i][hourglass_modes[static_cast<std::size_t>(a)]] = 0.125f * modes.hourglass[a][i];
        }
        modes_to_corners(x[i]);
    }
}

/// M e, and K q (see above).
[[gnu::always_inline]] inline void shear_of(const Lanes (&m)[6], const HexahedronModes& x,
                                            HexahedronModes& out) {
    constexpr float bend = 4.0f / 3.0f;
    constexpr float twist = 4.0f / 9.0f;
    const Lanes k12 = bend * (m[0] + m[1]);
    const Lanes k13 = bend * (m[0] + m[2]);
    const Lanes k23 = bend * (m[1] + m[2]);
    const Lanes k123 = twist * (m[0] + m[1] + m[2]);
    const Lanes m23 = bend * m[3];
    const Lanes m13 = bend * m[4];
    const Lanes m12 = bend * m[5];
    const Lanes(&e)[3][3] = x.edge;
    const Lanes(&q)[4][3] = x.hourglass;
    for (int i = 0; i < 3; ++i) {
        out.edge[0][i] = e[0][i] * m[0] + e[1][i] * m[5] + e[2][i] * m[4];
        out.edge[1][i] = e[0][i] * m[5] + e[1][i] * m[1] + e[2][i] * m[3];
        out.edge[2][i] = e[0][i] * m[4] + e[1][i] * m[3] + e[2][i] * m[2];
        out.hourglass[0][i] = k12 * q[0][i] + m23 * q[1][i] + m13 * q[2][i];
        out.hourglass[1][i] = m23 * q[0][i] + k13 * q[1][i] + m12 * q[2][i];
        out.hourglass[2][i] = m13 * q[0][i] + m12 * q[1][i] + k23 * q[2][i];
        out.hourglass[3][i] = k123 * q[3][i];
    }
}

/// Mean over the cell of the local edges' Gram matrix: the shear energy is mu V/2 times its product with M.
[[gnu::always_inline]] inline void mean_gram_of(const HexahedronModes& x, Lanes (&out)[6]) {
    constexpr float bend = 4.0f / 3.0f;
    constexpr float twist = 4.0f / 9.0f;
    const Lanes(&q)[4][3] = x.hourglass;
    gram_of(x.edge, out);
    Lanes square[4] = {};
    Lanes mixed[3] = {};
    for (int a = 0; a < 4; ++a) {
        add_dot(q[a], q[a], square[a]);
    }
    add_dot(q[0], q[1], mixed[0]);
    add_dot(q[0], q[2], mixed[1]);
    add_dot(q[1], q[2], mixed[2]);
    const Lanes every = twist * square[3];
    out[0] += bend * (square[0] + square[1]) + every;
    out[1] += bend * (square[0] + square[2]) + every;
    out[2] += bend * (square[1] + square[2]) + every;
    for (int k = 0; k < 3; ++k) {
        out[3 + k] += bend * mixed[k];
    }
}

/// The volume over det Q, [e1 e2 e3] + 4/3 ([q13 q23 e3] + [q12 e2 q23] + [e1 q12 q13]), and its gradient
/// without the last hourglass mode, which does not change it: `slope` [edges | first three modes].
/// `cofactor`: e2 x e3, e3 x e1, e1 x e2.
[[gnu::always_inline]] inline void volume_of(const HexahedronModes& x, Lanes& volume, Lanes (&cofactor)[3][3],
                                             Lanes (&slope)[6][3]) {
    constexpr float share = 4.0f / 3.0f;
    const Lanes(&e)[3][3] = x.edge;
    const Lanes(&q)[4][3] = x.hourglass;
    for (int u = 0; u < 3; ++u) {
        cross_to(e[(u + 1) % 3], e[(u + 2) % 3], cofactor[u]);
        for (int i = 0; i < 3; ++i) {
            slope[u][i] = cofactor[u][i];
            slope[u + 3][i] = Lanes{};
        }
    }
    volume = Lanes{};
    add_dot(e[0], cofactor[0], volume);
    constexpr int first[3] = {0, 2, 1};
    constexpr int second[3] = {1, 0, 2};
    for (int u = 0; u < 3; ++u) {  // [q12 q13 e1], [q23 q12 e2], [q13 q23 e3]
        Lanes turned[3];
        cross_to(q[first[u]], q[second[u]], turned);
        for (int i = 0; i < 3; ++i) {
            turned[i] *= share;
            slope[u][i] += turned[i];
        }
        add_dot(turned, e[u], volume);
        add_scaled_cross(Lanes{} + share, q[second[u]], e[u], slope[3 + first[u]]);
        add_scaled_cross(Lanes{} + share, e[u], q[first[u]], slope[3 + second[u]]);
    }
}

/// Slopes of the local volume ratio over 2 det Q: along axis 1 c2.q12 + c3.q13, and so on.
[[gnu::always_inline]] inline void volume_slopes(const Lanes (&cofactor)[3][3], const Lanes (&q)[4][3],
                                                 Lanes (&out)[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        out[axis] = Lanes{};
    }
    add_dot(cofactor[1], q[0], out[0]);
    add_dot(cofactor[2], q[1], out[0]);
    add_dot(cofactor[0], q[0], out[1]);
    add_dot(cofactor[2], q[2], out[1]);
    add_dot(cofactor[0], q[1], out[2]);
    add_dot(cofactor[1], q[2], out[2]);
}

[[gnu::always_inline]] inline void add_slope_forces(const Lanes (&slopes)[3], const Lanes (&cofactor)[3][3],
                                                    Lanes (&force)[4][3]) {
    for (int i = 0; i < 3; ++i) {
        force[0][i] += slopes[0] * cofactor[1][i] + slopes[1] * cofactor[0][i];
        force[1][i] += slopes[0] * cofactor[2][i] + slopes[2] * cofactor[0][i];
        force[2][i] += slopes[1] * cofactor[2][i] + slopes[2] * cofactor[1][i];
    }
}

/// Linearises these cells at the positions `wide`, and adds their forces and diagonal blocks to `sums`.
/// `ratio`: mu / lambda; `hardening`: relative growth of the hourglass stiffness with the mean square strain
/// of hourglass modes; `step`, `memory` and the result as of linearise_blocks().
[[gnu::always_inline]] inline bool linearise_hexahedra(const Hexahedra::Block* blocks,
                                                       ImplicitMesh::HexahedronElement* elements,
                                                       std::size_t count, const float* wide,
                                                       const ImplicitSums& sums, float ratio, float hardening,
                                                       const RelaxationStep& step = {},
                                                       RelaxedMetric* memory = nullptr) {
    constexpr float kappa = volume_gradient_stiffness;
    const Lanes none{};
    Lanes left = none;
    for (std::size_t n = 0; n < count; ++n) {
        const Hexahedra::Block& block = blocks[n];
        ImplicitMesh::HexahedronElement& out = elements[n];
        HexahedronModes x;
        Lanes at[3][8];
        gather_corners(wide, block, at);
        Lanes smallest_corner;
        smallest_corner_of(at, smallest_corner);
        modes_of(block, at, x);
        Lanes m[6];
        for (int k = 0; k < 6; ++k) {
            load(block.metric[k], m[k]);
        }
        Lanes scale;
        Lanes shear;
        load(block.inverse_determinant, scale);
        load(block.stiffness, shear);
        store(smallest_corner * scale, out.smallest_corner);
        if (memory != nullptr) {
            Lanes gram[6];
            mean_gram_of(x, gram);
            relax(gram, scale, step, memory[n], m, left);
        }
        Lanes cofactor[3][3];
        Lanes slope[6][3];
        Lanes strain;
        volume_of(x, strain, cofactor, slope);
        strain = (strain * scale - 1.0f - ratio) / ratio;
        HexahedronModes force;
        shear_of(m, x, force);
        Lanes trace = none;
        for (int u = 0; u < 3; ++u) {
            add_dot(x.edge[u], force.edge[u], trace);
        }
        Lanes hourglass = none;
        for (int a = 0; a < 4; ++a) {
            add_dot(x.hourglass[a], force.hourglass[a], hourglass);
        }
        hourglass = 1.0f + hardening * hourglass;
        store(hourglass, out.hourglass);
        Lanes stretch;
        largest_stretch_squared(x.edge, m, trace, stretch);
        Lanes cut;
        Lanes stiffened;
        clamp_tangent(strain, stretch, shear, cut, stiffened);
        for (int k = 0; k < 6; ++k) {
            store(stiffened * m[k], out.metric[k]);
        }
        for (int u = 0; u < 3; ++u) {
            for (int i = 0; i < 3; ++i) {
                store(x.edge[u][i], out.edge[u][i]);
                store(slope[u][i], out.slope[u][i]);
                store(slope[u + 3][i], out.slope[u + 3][i]);
            }
        }
        const Lanes bulk = shear * (1.0f / ratio) * scale * scale;
        const Lanes gradient = (4.0f / 3.0f) * kappa * shear * scale * scale;
        store(bulk, out.bulk);
        store(gradient, out.gradient);
        store(shear * cut * scale, out.pressure);

        const Lanes pressure = shear * strain * scale;
        for (int i = 0; i < 3; ++i) {
            for (int u = 0; u < 3; ++u) {
                force.edge[u][i] = shear * force.edge[u][i] + pressure * slope[u][i];
                force.hourglass[u][i] =
                    hourglass * shear * force.hourglass[u][i] + pressure * slope[u + 3][i];
            }
            force.hourglass[3][i] *= hourglass * shear;
        }
        Lanes slopes[3];
        volume_slopes(cofactor, x.hourglass, slopes);
        for (Lanes& s : slopes) {
            s *= gradient;
        }
        add_slope_forces(slopes, cofactor, force.hourglass);
        {
            const Lanes(&e)[3][3] = x.edge;
            const Lanes(&q)[4][3] = x.hourglass;
            // c2 = e3 x e1, so that c2.q12 depends on e3 and e1; and so on.
            add_scaled_cross(slopes[0], q[0], e[2], force.edge[0]);
            add_scaled_cross(slopes[0], e[1], q[1], force.edge[0]);
            add_scaled_cross(slopes[0], q[1], e[0], force.edge[1]);
            add_scaled_cross(slopes[0], e[0], q[0], force.edge[2]);
            add_scaled_cross(slopes[1], e[1], q[2], force.edge[0]);
            add_scaled_cross(slopes[1], e[2], q[0], force.edge[1]);
            add_scaled_cross(slopes[1], q[2], e[0], force.edge[1]);
            add_scaled_cross(slopes[1], q[0], e[1], force.edge[2]);
            add_scaled_cross(slopes[2], q[2], e[2], force.edge[0]);
            add_scaled_cross(slopes[2], e[2], q[1], force.edge[1]);
            add_scaled_cross(slopes[2], q[1], e[1], force.edge[2]);
            add_scaled_cross(slopes[2], e[0], q[2], force.edge[2]);
        }
        Lanes f[3][8];
        corners_of(block, force, f);

        // Diagonal blocks: edges have a quarter of a corner's displacement, hourglass modes an eighth.
        HexahedronModes volume;
        for (int i = 0; i < 3; ++i) {
            for (int u = 0; u < 3; ++u) {
                volume.edge[u][i] = slope[u][i];
                volume.hourglass[u][i] = slope[u + 3][i];
            }
            volume.hourglass[3][i] = none;
        }
        Lanes h[3][8];
        corners_of(block, volume, h);
        constexpr float bending = 1.0f / 24.0f + 1.0f / 144.0f;
        const Lanes every =
            stiffened * (m[0] + m[1] + m[2]) * (1.0f / 16.0f + bending * hourglass + kappa / 72.0f);
        for (unsigned v = 0; v < 8; ++v) {
            const auto s1 = static_cast<float>(hexahedron_sign(1, v));
            const auto s2 = static_cast<float>(hexahedron_sign(2, v));
            const auto s3 = static_cast<float>(hexahedron_sign(4, v));
            const Lanes own = every + stiffened * 0.125f * (s1 * s2 * m[5] + s1 * s3 * m[4] + s2 * s3 * m[3]);
            Lanes on_corner[3];
            Lanes square[3];
            Lanes mixed[3];
            for (int i = 0; i < 3; ++i) {
                on_corner[i] = f[i][v];
                square[i] = bulk * h[i][v] * h[i][v];
                mixed[i] = bulk * h[(i + 1) % 3][v] * h[(i + 2) % 3][v];
            }
            scatter_add(sums.gradient, block.corner[v], on_corner, own);
            scatter_add(sums.square, block.corner[v], square, none);
            scatter_add(sums.mixed, block.corner[v], mixed, none);
        }
    }
    return any_positive(left);
}

/// Adds K times `from`, over these cells, to `to`. K lacks the derivatives of the hardening, of the pressure
/// across edges and hourglass modes, and those of the volume's gradient beyond its Gauss-Newton part along
/// hourglass modes, which keeps it positive definite and changes no equilibrium.
[[gnu::always_inline]] inline void apply_hexahedra(const Hexahedra::Block* blocks,
                                                   const ImplicitMesh::HexahedronElement* elements,
                                                   std::size_t count, const float* from, float* to) {
    constexpr float share = 4.0f / 3.0f;
    const Lanes none{};
    for (std::size_t n = 0; n < count; ++n) {
        const Hexahedra::Block& block = blocks[n];
        const ImplicitMesh::HexahedronElement& element = elements[n];
        HexahedronModes p;
        gather_modes(from, block, p);
        Lanes m[6];
        for (int k = 0; k < 6; ++k) {
            load(element.metric[k], m[k]);
        }
        Lanes bulk;
        Lanes pressure;
        Lanes hourglass;
        Lanes gradient;
        load(element.bulk, bulk);
        load(element.pressure, pressure);
        load(element.hourglass, hourglass);
        load(element.gradient, gradient);
        Lanes edge[3][3];
        Lanes slope[6][3];
        Lanes change = none;
        for (int u = 0; u < 3; ++u) {
            for (int i = 0; i < 3; ++i) {
                load(element.edge[u][i], edge[u][i]);
                load(element.slope[u][i], slope[u][i]);
                load(element.slope[u + 3][i], slope[u + 3][i]);
                change += slope[u][i] * p.edge[u][i] + slope[u + 3][i] * p.hourglass[u][i];
            }
        }
        change *= bulk;
        HexahedronModes y;
        shear_of(m, p, y);
        Lanes cofactor[3][3];
        for (int u = 0; u < 3; ++u) {
            cross_to(edge[(u + 1) % 3], edge[(u + 2) % 3], cofactor[u]);
        }
        Lanes slopes[3];
        volume_slopes(cofactor, p.hourglass, slopes);
        for (Lanes& s : slopes) {
            s *= gradient;
        }
        for (int i = 0; i < 3; ++i) {
            for (int u = 0; u < 3; ++u) {
                y.edge[u][i] += change * slope[u][i];
                y.hourglass[u][i] = hourglass * y.hourglass[u][i] + change * slope[u + 3][i];
            }
            y.hourglass[3][i] *= hourglass;
        }
        add_slope_forces(slopes, cofactor, y.hourglass);
        const Lanes(&d)[4][3] = p.hourglass;
        for (int u = 0; u < 3; ++u) {
            const int v = (u + 1) % 3;
            const int w = (u + 2) % 3;
            add_scaled_cross(pressure, p.edge[v], edge[w], y.edge[u]);
            add_scaled_cross(pressure, edge[v], p.edge[w], y.edge[u]);
        }
        constexpr int first[3] = {0, 2, 1};
        constexpr int second[3] = {1, 0, 2};
        const Lanes part = share * pressure;
        for (int u = 0; u < 3; ++u) {
            add_scaled_cross(part, d[second[u]], edge[u], y.hourglass[first[u]]);
            add_scaled_cross(part, edge[u], d[first[u]], y.hourglass[second[u]]);
        }
        Lanes x[3][8];
        corners_of(block, y, x);
        for (int v = 0; v < 8; ++v) {
            const Lanes on_corner[3] = {x[0][v], x[1][v], x[2][v]};
            scatter_add(to, block.corner[v], on_corner, none);
        }
    }
}

}  // namespace eti::pbd
