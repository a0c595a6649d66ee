// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "server/parallel/loops.hpp"
#include "server/pbd/fluid/fluid.hpp"
#include "server/pbd/fluid/fluid_solid.hpp"
#include "server/pbd/lanes.hpp"

namespace eti::pbd {

namespace {

// 2 (d + 2) in the literature, for sums that approximate integrals. Particles of a liquid keep about one
// spacing apart, where the kernel is steepest: a shear wave then decays at 0.58 of the correct rate.
constexpr float viscous_factor = 10.0f / 0.58f;
constexpr float far_away = 1e6f;  // [m], position of padding

[[gnu::always_inline]] inline float sum_of_lanes(const Lanes& x) {
    const Float4 four = __builtin_shufflevector(x, x, 0, 1, 2, 3) + __builtin_shufflevector(x, x, 4, 5, 6, 7);
    return (four[0] + four[1]) + (four[2] + four[3]);
}

}  // namespace

/// The particles in the 27 cells around a cell, as candidates for the particles in it, and the neighbours
/// chosen by one of these.
struct Fluid::Candidates {
    static constexpr std::size_t most = 1024;  // nearly five times the number in 27 cells at rest
    static constexpr std::size_t padded = most + lane_count;
    using Numbers = std::array<float, padded>;
    using Places = std::array<std::uint32_t, padded>;
    struct Box {
        std::array<float, 3> low, high;
    };
    std::size_t count = 0;
    std::uint32_t first = 0;  ///< particle of the first candidate; the middle cell's come first
    std::uint64_t dropped = 0;
    alignas(32) Numbers x, y, z;
    alignas(32) Places particle;  ///< times four
    // Of the chosen ones: offset to the particle that chooses.
    alignas(32) Numbers dx, dy, dz;
    alignas(32) Places chosen;

    /// Adds the particles of a run within a distance of a box.
    void add(const std::array<std::vector<float>, 3>& axis, CellGrid::Run run, const Box& box,
             float squared_distance);
    void add_avx2(const std::array<std::vector<float>, 3>& axis, CellGrid::Run run, const Box& box,
                  float squared_distance);
    /// Lists the candidates within a distance of a point; returns their number.
    [[nodiscard]] std::size_t choose(const Vec4f& at, float squared_distance);
    [[nodiscard]] std::size_t choose_avx2(const Vec4f& at, float squared_distance);
};

void Fluid::Candidates::add(const std::array<std::vector<float>, 3>& axis, CellGrid::Run run, const Box& box,
                            float squared_distance) {
    for (std::uint32_t j = run.first; j < run.second; ++j) {
        if (count == most) {
            dropped += run.second - j;
            return;
        }
        float squared = 0.0f;
        for (std::size_t a = 0; a < 3; ++a) {
            const float p = axis[a][j];
            const float away = std::max(std::max(box.low[a] - p, p - box.high[a]), 0.0f);
            squared += away * away;
        }
        x[count] = axis[0][j];
        y[count] = axis[1][j];
        z[count] = axis[2][j];
        particle[count] = 4 * j;
        // Branch-free: it would be mispredicted.
        count += squared < squared_distance ? 1 : 0;
    }
}

std::size_t Fluid::Candidates::choose(const Vec4f& at, float squared_distance) {
    std::size_t n = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const float a = at.x() - x[k];
        const float b = at.y() - y[k];
        const float c = at.z() - z[k];
        dx[n] = a;
        dy[n] = b;
        dz[n] = c;
        chosen[n] = particle[k];
        // Branch-free: it would be mispredicted.
        n += a * a + b * b + c * c < squared_distance ? 1 : 0;
    }
    return n;
}

#if defined(__x86_64__)
namespace {

/// For each lane mask: its set lanes in order.
constexpr auto packing = [] {
    std::array<std::array<std::uint8_t, lane_count>, 256> order{};
    for (std::size_t set = 0; set < order.size(); ++set) {
        std::size_t n = 0;
        for (std::uint8_t lane = 0; lane < lane_count; ++lane) {
            if ((set >> lane & 1) != 0) {
                order[set][n++] = lane;
            }
        }
    }
    return order;
}();

}  // namespace

[[gnu::target("avx2,popcnt")]] void Fluid::Candidates::add_avx2(const std::array<std::vector<float>, 3>& axis,
                                                                CellGrid::Run run, const Box& box,
                                                                float squared_distance) {
    const __m256 limit = _mm256_set1_ps(squared_distance);
    std::uint32_t j = run.first;
    for (; j < run.second && count + lane_count <= most; j += lane_count) {
        __m256 p[3];
        __m256 squared = _mm256_setzero_ps();
        for (std::size_t a = 0; a < 3; ++a) {
            p[a] = _mm256_loadu_ps(&axis[a][j]);
            const __m256 below = _mm256_sub_ps(_mm256_set1_ps(box.low[a]), p[a]);
            const __m256 above = _mm256_sub_ps(p[a], _mm256_set1_ps(box.high[a]));
            const __m256 away = _mm256_max_ps(_mm256_max_ps(below, above), _mm256_setzero_ps());
            squared = _mm256_add_ps(squared, _mm256_mul_ps(away, away));
        }
        auto set = static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(squared, limit, _CMP_LT_OQ)));
        if (run.second - j < lane_count) {
            set &= (1u << (run.second - j)) - 1u;
        }
        const __m256i order =
            _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(packing[set].data())));
        _mm256_storeu_ps(&x[count], _mm256_permutevar8x32_ps(p[0], order));
        _mm256_storeu_ps(&y[count], _mm256_permutevar8x32_ps(p[1], order));
        _mm256_storeu_ps(&z[count], _mm256_permutevar8x32_ps(p[2], order));
        _mm256_storeu_si256(
            reinterpret_cast<__m256i*>(&particle[count]),
            _mm256_slli_epi32(_mm256_add_epi32(_mm256_set1_epi32(static_cast<int>(j)), order), 2));
        count += static_cast<std::size_t>(_mm_popcnt_u32(set));
    }
    add(axis, {std::min(j, run.second), run.second}, box, squared_distance);
}

[[gnu::target("avx2,popcnt")]] std::size_t Fluid::Candidates::choose_avx2(const Vec4f& at,
                                                                          float squared_distance) {
    const __m256 ax = _mm256_set1_ps(at.x()), ay = _mm256_set1_ps(at.y()), az = _mm256_set1_ps(at.z());
    const __m256 limit = _mm256_set1_ps(squared_distance);
    std::size_t n = 0;
    for (std::size_t k = 0; k < count; k += lane_count) {
        const __m256 a = _mm256_sub_ps(ax, _mm256_load_ps(&x[k]));
        const __m256 b = _mm256_sub_ps(ay, _mm256_load_ps(&y[k]));
        const __m256 c = _mm256_sub_ps(az, _mm256_load_ps(&z[k]));
        const __m256 squared =
            _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(a, a), _mm256_mul_ps(b, b)), _mm256_mul_ps(c, c));
        const auto set = static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(squared, limit, _CMP_LT_OQ)));
        const __m256i order =
            _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(packing[set].data())));
        _mm256_storeu_ps(&dx[n], _mm256_permutevar8x32_ps(a, order));
        _mm256_storeu_ps(&dy[n], _mm256_permutevar8x32_ps(b, order));
        _mm256_storeu_ps(&dz[n], _mm256_permutevar8x32_ps(c, order));
        const __m256i places = _mm256_load_si256(reinterpret_cast<const __m256i*>(&particle[k]));
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(&chosen[n]),
                            _mm256_permutevar8x32_epi32(places, order));
        n += static_cast<std::size_t>(_mm_popcnt_u32(set));
    }
    return n;
}
#else
void Fluid::Candidates::add_avx2(const std::array<std::vector<float>, 3>& axis, CellGrid::Run run,
                                 const Box& box, float squared_distance) {
    add(axis, run, box, squared_distance);
}
std::size_t Fluid::Candidates::choose_avx2(const Vec4f& at, float squared_distance) {
    return choose(at, squared_distance);
}
#endif

void Fluid::gather(std::uint32_t cell, Candidates& candidates) {
    // The cell's own particles first, so that none of them is dropped.
    const CellGrid::Run own = grid_.within(cell);
    Candidates::Box box;
    box.low.fill(far_away);
    box.high.fill(-far_away);
    for (std::uint32_t j = own.first; j < own.second; ++j) {
        for (std::size_t a = 0; a < 3; ++a) {
            box.low[a] = std::min(box.low[a], axis_[a][j]);
            box.high[a] = std::max(box.high[a], axis_[a][j]);
        }
    }
    candidates.count = 0;
    candidates.first = own.first;
    // Slightly larger than the radius, to cover rounding.
    const float within = 1.001f * kernel_.radius * kernel_.radius;
    const auto add = [&](const CellGrid::Run& run) {
        avx2_ ? candidates.add_avx2(axis_, run, box, within) : candidates.add(axis_, run, box, within);
    };
    add(own);
    const auto runs = grid_.neighbours(cell);
    for (std::size_t k = 0; k < runs.size(); ++k) {
        if (k == 4) {
            add({runs[k].first, own.first});
            add({own.second, runs[k].second});
        } else {
            add(runs[k]);
        }
    }
    const std::size_t n = candidates.count;
    // Padding lanes are out of everyone's reach.
    for (std::size_t k = n; k < n + lane_count; ++k) {
        candidates.x[k] = candidates.y[k] = candidates.z[k] = far_away;
        candidates.particle[k] = 0;
    }
}

[[gnu::always_inline]] inline void Fluid::add_pair_terms(std::size_t i, float dt, Candidates& candidates) {
    const float h_squared = kernel_.radius * kernel_.radius;
    // Excludes the particle itself.
    const std::size_t self = std::min<std::size_t>(i - candidates.first, Candidates::most);
    const float own_x = candidates.x[self];
    candidates.x[self] = far_away;
    std::size_t n =
        avx2_ ? candidates.choose_avx2(local_[i], h_squared) : candidates.choose(local_[i], h_squared);
    candidates.x[self] = own_x;
    if (n > max_neighbours) {
        candidates.dropped += n - max_neighbours;
        n = max_neighbours;
    }
    // Padding lanes lie at the kernel's edge, where every term is zero.
    for (std::size_t k = n; k % lane_count != 0; ++k) {
        candidates.dx[k] = kernel_.radius;
        candidates.dy[k] = candidates.dz[k] = 0.0f;
        candidates.chosen[k] = static_cast<std::uint32_t>(4 * i);
    }
    // The explicit step removes the fraction dt nu s of a particle's velocity relative to its neighbours,
    // with s = viscous_factor V sum of |W'| / r times a squared cosine, about 13 / spacing^2: at most two
    // thirds.
    const float viscosity =
        viscous_factor * std::min(settings_.viscosity, 0.05f * settings_.spacing * settings_.spacing / dt);
    const float softening = 0.01f * h_squared;
    const float* const rates = rate_.front().data();
    const Vec4f rate = rate_[i];
    float* const slope = &slope_[first_pair_[i]];
    std::uint32_t* const neighbour = &neighbour_[first_pair_[i]];
    Lanes density{}, steep{}, gx{}, gy{}, gz{}, ax{}, ay{}, az{};
    for (std::size_t k = 0; k < n; k += lane_count) {
        Lanes x;
        Lanes y;
        Lanes z;
        load(&candidates.dx[k], x);
        load(&candidates.dy[k], y);
        load(&candidates.dz[k], z);
        const Lanes squared = x * x + y * y + z * z;
        Lanes r = squared;
        sqrt_in_place(r);
        const Lanes relative = r * kernel_.inverse_radius;
        const Lanes q = relative < 1.0f ? relative : Lanes{} + 1.0f;
        const Lanes t = 1.0f - q;
        const Lanes cubed = t * t * t;
        density += cubed * t * (4.0f * q + 1.0f);
        const Lanes g = (-kernel_.slope * kernel_volume_) * cubed;
        store(g, slope + k);
        std::memcpy(neighbour + k, &candidates.chosen[k], lane_count * sizeof(std::uint32_t));
        steep += g * g * squared;
        gx += g * x;
        gy += g * y;
        gz += g * z;
        Lanes other[3];
        Lanes unused;
        pbd::gather(rates, &candidates.chosen[k], other, unused);
        const Lanes closing =
            x * (rate.x() - other[0]) + y * (rate.y() - other[1]) + z * (rate.z() - other[2]);
        Lanes cohesion;
        cohesion_shape(q, cohesion);
        // viscosity closing g / (squared + softening) - attraction cohesion / r, with a single division.
        const Lanes soft = squared + softening;
        const Lanes away = r + 1e-6f * kernel_.radius;
        const Lanes a = (viscosity * closing * g * away - attraction_ * cohesion * soft) / (soft * away);
        ax += a * x;
        ay += a * y;
        az += a * z;
    }
    neighbours_[i] = static_cast<std::uint32_t>((n + lane_count - 1) / lane_count * lane_count);

    compression_[i] += kernel_volume_ * kernel_.peak * (1.0f + sum_of_lanes(density)) - 1.0f;
    // By component: a vector assembled from scalars and read at once stalls the processor.
    Vec4f& own = own_gradient_[i];
    own.x() += sum_of_lanes(gx);
    own.y() += sum_of_lanes(gy);
    own.z() += sum_of_lanes(gz);
    diagonal_[i] = sum_of_lanes(steep) + own.x() * own.x() + own.y() * own.y() + own.z() * own.z();
    Vec4f& offset = offset_[i];
    offset.x() += dt * dt * sum_of_lanes(ax);
    offset.y() += dt * dt * sum_of_lanes(ay);
    offset.z() += dt * dt * sum_of_lanes(az);
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void Fluid::add_pair_terms_avx2(std::size_t i, float dt, Candidates& candidates) {
    add_pair_terms(i, dt, candidates);
}
#else
void Fluid::add_pair_terms_avx2(std::size_t i, float dt, Candidates& candidates) {
    add_pair_terms(i, dt, candidates);
}
#endif

void Fluid::collect(float dt, float scale, const FluidSurroundings& surroundings) {
    parallel::for_ranges(awake_.size(), grain, [&](std::size_t begin, std::size_t end) {
        collect(begin, end, dt, scale, surroundings);
    });
}

void Fluid::collect(std::size_t begin, std::size_t end, float dt, float scale,
                    const FluidSurroundings& surroundings) {
    const std::optional<FluidSolid> solid = solid_of(surroundings);
    Candidates candidates;
    std::uint32_t cell = 0;
    // Pairs are stored consecutively, so that memory is read as one stream; capacity is sufficient for all.
    std::size_t pair = max_neighbours * begin;
    for (std::size_t k = begin; k != end; ++k) {
        const std::uint32_t i = awake_[k];
        if (k == begin || grid_.cell_at(i) != cell) {
            cell = grid_.cell_at(i);
            gather(cell, candidates);
        }
        find_walls(i, dt, solid.has_value() ? &*solid : nullptr, surroundings.capsules);
        first_pair_[i] = static_cast<std::uint32_t>(pair);
        avx2_ ? add_pair_terms_avx2(i, dt, candidates) : add_pair_terms(i, dt, candidates);
        multiplier_[i] *= scale;
        push_[i] = multiplier_[i] * local_[i];
        pair += neighbours_[i];
    }
    std::atomic_ref(dropped_neighbours_).fetch_add(candidates.dropped, std::memory_order_relaxed);
}

}  // namespace eti::pbd
