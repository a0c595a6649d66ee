// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/accuracy/xpbd_tetrahedra.hpp"

#include "server/parallel/loops.hpp"
#include "server/pbd/lanes.hpp"
#include "server/pbd/soft/neo_hookean.hpp"

namespace eti::bench {

namespace {

using pbd::Lanes;
using pbd::Tetrahedra;

// Every output has one writer and no sum crosses a range: results do not depend on the partition.
constexpr std::size_t block_grain = 32;
constexpr std::size_t corner_grain = 2048;

/// tr(F^T F) below which the deviatoric constraint is skipped. For F = s 1 the force of the energy above
/// vanishes at s = 1, at 0, and between them at the root of ratio - (1 + ratio) s + s^4, which lies within
/// 1.09 of ratio / (1 + ratio): a smaller tetrahedron would collapse to a point. A factor of 1.2 is safe: a
/// cube under pressure buckles from s = (ratio / 3)^(1/4) on, which for a Poisson ratio of 0.2 (0.45) is 0.67
/// (0.43), against 0.45 (0.11) here.
template <class T>
[[nodiscard]] constexpr T neo_hookean_collapsed(T ratio) {
    const T s = T(1.2) * ratio / (T(1) + ratio);
    return T(3) * s * s + T(1e-6);
}

/// Moves the corners `x` [m] of a tetrahedron by one XPBD step on both constraints at once, from multipliers
/// of zero:
///     (alpha / dt^2 + grad C^T W grad C) Delta lambda = -C, alpha_D = 1 / (mu V), alpha_H = 1 / (lambda V).
/// Projected sequentially, as in the paper, they would disturb a body at rest: there neither vanishes, only
/// their forces cancel. Rows are scaled by C_D and mu V dt^2. `inverse_mass` [1/kg], `stiffness` = mu V dt^2
/// [kg m^2], `ratio` = mu / lambda > 0.
template <class T>
[[gnu::always_inline]] inline void project_neo_hookean(T (&x)[4][3], const T (&inverse_mass)[4],
                                                       const pbd::RestTetrahedron<T>& rest,
                                                       const T& stiffness, const T& ratio,
                                                       const T& collapsed) {
    pbd::NeoHookean<T> c;
    pbd::neo_hookean(x, rest, c);
    T weight[4];
    T dd{};
    T hh{};
    for (int v = 0; v < 4; ++v) {
        const T(&d)[3] = c.deviatoric[v];
        const T(&h)[3] = c.hydrostatic[v];
        weight[v] = inverse_mass[v] * stiffness;
        dd += weight[v] * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        hh += weight[v] * (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
    }
    // F^T cof F = det F 1: the product of the gradients is det F times the weighted sum of squared rows of Q.
    const T(&m)[6] = rest.metric;
    T dh = c.determinant * (weight[1] * m[0] + weight[2] * m[1] + weight[3] * m[2] +
                            weight[0] * (m[0] + m[1] + m[2] + 2.0f * (m[3] + m[4] + m[5])));
    const T none{};
    const T n = c.trace > collapsed ? c.trace : none;
    dd = c.trace > collapsed ? dd : collapsed;  // any positive number
    dh = c.trace > collapsed ? dh : none;
    const T lacking = ratio + 1.0f - c.determinant;  // -C_H
    // Where both gradients are parallel (at rest) their Gram determinant is rounding error only; it is never
    // negative.
    T gram = dd * hh - dh * dh;
    gram = gram > none ? gram : none;
    const T scale = 1.0f / (gram + dd * ratio + n * (hh + ratio));
    const T along_deviatoric = -(n * (hh + ratio) + dh * lacking) * scale;
    const T along_hydrostatic = ((dd + n) * lacking + dh * n) * scale;
    for (int v = 0; v < 4; ++v) {
        for (int i = 0; i < 3; ++i) {
            x[v][i] +=
                weight[v] * (along_deviatoric * c.deviatoric[v][i] + along_hydrostatic * c.hydrostatic[v][i]);
        }
    }
}

[[gnu::always_inline]] inline void project_blocks(const Tetrahedra::Block* block, std::size_t count,
                                                  float* wide, float dt_squared, float ratio) {
    const Lanes ratios = Lanes{} + ratio;
    const Lanes collapsed = Lanes{} + neo_hookean_collapsed(ratio);
    for (const Tetrahedra::Block* b = block; b != block + count; ++b) {
        Lanes x[4][3];
        Lanes inverse_mass[4];
        for (int v = 0; v < 4; ++v) {
            pbd::gather(wide, b->corner[v], x[v], inverse_mass[v]);
        }
        pbd::RestTetrahedron<Lanes> rest;
        for (int k = 0; k < 6; ++k) {
            pbd::load(b->metric[k], rest.metric[k]);
        }
        pbd::load(b->inverse_determinant, rest.inverse_determinant);
        Lanes stiffness;
        pbd::load(b->stiffness, stiffness);
        stiffness *= dt_squared;
        project_neo_hookean(x, inverse_mass, rest, stiffness, ratios, collapsed);
        for (int v = 0; v < 4; ++v) {
            pbd::scatter(wide, b->corner[v], x[v], inverse_mass[v]);
        }
    }
}

void project_blocks_baseline(const Tetrahedra::Block* block, std::size_t count, float* wide, float dt_squared,
                             float ratio) {
    project_blocks(block, count, wide, dt_squared, ratio);
}
#if defined(__x86_64__)
[[gnu::target("avx2")]] void project_blocks_avx2(const Tetrahedra::Block* block, std::size_t count,
                                                 float* wide, float dt_squared, float ratio) {
    project_blocks(block, count, wide, dt_squared, ratio);
}
#else
constexpr auto project_blocks_avx2 = project_blocks_baseline;
#endif

}  // namespace

void XpbdTetrahedra::configure(const Tetrahedra::Description& description, const pbd::Particles& particles) {
    mesh_.configure(description, particles);
    ratio_ = pbd::neo_hookean_ratio(description.poisson_ratio);
    wide_.assign(mesh_.particles().size() + 4 * Tetrahedra::lanes, Eigen::Vector4f::Zero());
}

void XpbdTetrahedra::project(pbd::Particles& particles, float dt) {
    if (mesh_.size() == 0) {
        return;
    }
    const auto used = mesh_.particles();
    parallel::for_each(used.size(), corner_grain, [&](std::size_t k) {
        wide_[k] << particles.predicted[used[k]], particles.inverse_mass[used[k]];
    });
    const auto kernel = pbd::has_avx2() ? project_blocks_avx2 : project_blocks_baseline;
    for (std::size_t colour = 0; colour < mesh_.colours(); ++colour) {
        const auto blocks = mesh_.blocks(colour);
        parallel::for_ranges(blocks.size(), block_grain, [&](std::size_t begin, std::size_t end) {
            kernel(blocks.data() + begin, end - begin, wide_.front().data(), dt * dt, ratio_);
        });
    }
    parallel::for_each(used.size(), corner_grain,
                       [&](std::size_t k) { particles.predicted[used[k]] = wide_[k].head<3>(); });
}

}  // namespace eti::bench
