// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::pbd {

// Kernels of one stable neo-Hookean tetrahedron for any T with arithmetic: float, double, or a vector of
// floats with one tetrahedron per lane. No square root, no branch and one division, so that results are
// bit-identical for every lane count and instruction set.

/// Rest shape of a tetrahedron, with Q = [X1 - X0, X2 - X0, X3 - X0]^-1.
template <class T>
struct RestTetrahedron {
    T metric[6];            ///< Q Q^T: 11, 22, 33, 23, 13, 12 [1/m^2]
    T inverse_determinant;  ///< det Q: 1 / (6 V), negative for a left-handed order of corners [1/m^3]
};

/// Constraints of a tetrahedron and their gradients by corner.
template <class T>
struct NeoHookean {
    T trace;              ///< tr(F^T F) = C_D^2
    T determinant;        ///< det F = C_H + gamma
    T deviatoric[4][3];   ///< C_D grad C_D, half the gradient of the trace; zero where C_D is
    T hydrostatic[4][3];  ///< grad C_H, gradient of the determinant
};

/// Constraints of Macklin & Müller 2021, "A constraint-based formulation of stable neo-Hookean materials":
///     C_D = sqrt(tr(F^T F)),  C_H = det F - gamma,  F = D Q,  D = [x1 - x0, x2 - x0, x3 - x0].
/// With dC_D/dF = F / C_D and dC_H/dF = cof F, the gradients by x1, x2, x3 are the columns of
///     F Q^T / C_D = D (Q Q^T) / C_D  and  cof F Q^T = det Q cof D,
/// so that F itself is not needed.
template <class T>
[[gnu::always_inline]] inline void neo_hookean(const T (&x)[4][3], const RestTetrahedron<T>& rest,
                                               NeoHookean<T>& out) {
    const T(&m)[6] = rest.metric;
    T edge[3][3];
    for (int v = 0; v < 3; ++v) {
        for (int i = 0; i < 3; ++i) {
            edge[v][i] = x[v + 1][i] - x[0][i];
        }
    }
    T(&d)[4][3] = out.deviatoric;
    T(&h)[4][3] = out.hydrostatic;
    for (int i = 0; i < 3; ++i) {
        d[1][i] = edge[0][i] * m[0] + edge[1][i] * m[5] + edge[2][i] * m[4];
        d[2][i] = edge[0][i] * m[5] + edge[1][i] * m[1] + edge[2][i] * m[3];
        d[3][i] = edge[0][i] * m[4] + edge[1][i] * m[3] + edge[2][i] * m[2];
        d[0][i] = -(d[1][i] + d[2][i] + d[3][i]);
    }
    out.trace = T{};
    for (int v = 0; v < 3; ++v) {
        out.trace += edge[v][0] * d[v + 1][0] + edge[v][1] * d[v + 1][1] + edge[v][2] * d[v + 1][2];
    }
    T scaled[3];
    for (int i = 0; i < 3; ++i) {
        scaled[i] = rest.inverse_determinant * edge[2][i];
    }
    for (int i = 0; i < 3; ++i) {
        const int k = (i + 1) % 3;
        const int l = (i + 2) % 3;
        h[1][i] = edge[1][k] * scaled[l] - edge[1][l] * scaled[k];
        h[2][i] = scaled[k] * edge[0][l] - scaled[l] * edge[0][k];
        h[3][i] = rest.inverse_determinant * (edge[0][k] * edge[1][l] - edge[0][l] * edge[1][k]);
        h[0][i] = -(h[1][i] + h[2][i] + h[3][i]);
    }
    out.determinant = edge[0][0] * h[1][0] + edge[0][1] * h[1][1] + edge[0][2] * h[1][2];
}

/// mu / lambda of the energy mu/2 (tr(F^T F) - 3) + lambda/2 (det F - gamma)^2. Its rest state is F = 1 for
/// gamma = 1 + mu/lambda. There it linearises to Hooke's law with the shear modulus mu and the first Lamé
/// parameter lambda - mu (Smith, de Goes & Kim 2018, "Stable neo-Hookean flesh simulation", whose logarithmic
/// term Macklin & Müller omit). Hence mu = E / (2 (1 + nu)) and mu / lambda = 1 - 2 nu.
template <class T>
[[nodiscard]] constexpr T neo_hookean_ratio(T poisson_ratio) {
    return T(1) - T(2) * poisson_ratio;
}

}  // namespace eti::pbd
