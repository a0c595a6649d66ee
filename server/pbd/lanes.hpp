// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace eti::pbd {

// Eight floats that go through a kernel together. The compiler makes of them what the instruction set at
// hand has, with the same bits (no fused operations): a kernel is inlined into one function for the baseline
// and one for AVX2, and has_avx2() says which to call.

// A store of lanes may change anything, also where a vector's numbers lie, as far as the compiler knows.
// Loops that store therefore keep pointers of their own.

using Four = float __attribute__((vector_size(16)));
using Lanes = float __attribute__((vector_size(32)));
inline constexpr std::size_t lane_count = 8;
static_assert(sizeof(Eigen::Vector4f) == sizeof(Four));

[[gnu::always_inline]] inline void load(const float* from, Lanes& to) {
    std::memcpy(&to, from, sizeof to);
}

[[nodiscard]] [[gnu::always_inline]] inline Four four(const float* from) {
    Four out;
    std::memcpy(&out, from, sizeof out);
    return out;
}
[[nodiscard]] [[gnu::always_inline]] inline Four four(const Eigen::Vector4f& from) {
    return four(from.data());
}

[[gnu::always_inline]] inline void put(const Four& from, float* to) {
    std::memcpy(to, &from, sizeof from);
}
[[gnu::always_inline]] inline void put(const Four& from, Eigen::Vector4f& to) {
    put(from, to.data());
}

/// Square roots: correctly rounded, so the same bits from every instruction set. One instruction where
/// sources are compiled with -fno-math-errno.
[[gnu::always_inline]] inline void take_root(Lanes& of) {
    for (std::size_t l = 0; l < lane_count; ++l) {
        of[l] = std::sqrt(of[l]);
    }
}

/// Eight vectors x, y, z, w that begin `at` numbers of `from`, one to a lane: a transposition of 8 by 4.
[[gnu::always_inline]] inline void gather(const float* from, const std::uint32_t* at, Lanes (&xyz)[3],
                                          Lanes& w) {
    Lanes row[4];  // quadruple l and l + 4
    for (int l = 0; l < 4; ++l) {
        Four low;
        Four high;
        std::memcpy(&low, from + at[l], sizeof low);
        std::memcpy(&high, from + at[l + 4], sizeof high);
        row[l] = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
    }
    const Lanes a = __builtin_shufflevector(row[0], row[1], 0, 8, 1, 9, 4, 12, 5, 13);
    const Lanes b = __builtin_shufflevector(row[0], row[1], 2, 10, 3, 11, 6, 14, 7, 15);
    const Lanes c = __builtin_shufflevector(row[2], row[3], 0, 8, 1, 9, 4, 12, 5, 13);
    const Lanes d = __builtin_shufflevector(row[2], row[3], 2, 10, 3, 11, 6, 14, 7, 15);
    xyz[0] = __builtin_shufflevector(a, c, 0, 1, 8, 9, 4, 5, 12, 13);
    xyz[1] = __builtin_shufflevector(a, c, 2, 3, 10, 11, 6, 7, 14, 15);
    xyz[2] = __builtin_shufflevector(b, d, 0, 1, 8, 9, 4, 5, 12, 13);
    w = __builtin_shufflevector(b, d, 2, 3, 10, 11, 6, 7, 14, 15);
}

/// The same back: vectors of lanes l and l + 4, for l from 0 to 3.
[[gnu::always_inline]] inline void transpose(const Lanes (&xyz)[3], const Lanes& w, Lanes (&row)[4]) {
    const Lanes a = __builtin_shufflevector(xyz[0], xyz[1], 0, 8, 1, 9, 4, 12, 5, 13);
    const Lanes b = __builtin_shufflevector(xyz[0], xyz[1], 2, 10, 3, 11, 6, 14, 7, 15);
    const Lanes c = __builtin_shufflevector(xyz[2], w, 0, 8, 1, 9, 4, 12, 5, 13);
    const Lanes d = __builtin_shufflevector(xyz[2], w, 2, 10, 3, 11, 6, 14, 7, 15);
    row[0] = __builtin_shufflevector(a, c, 0, 1, 8, 9, 4, 5, 12, 13);
    row[1] = __builtin_shufflevector(a, c, 2, 3, 10, 11, 6, 7, 14, 15);
    row[2] = __builtin_shufflevector(b, d, 0, 1, 8, 9, 4, 5, 12, 13);
    row[3] = __builtin_shufflevector(b, d, 2, 3, 10, 11, 6, 7, 14, 15);
}

[[gnu::always_inline]] inline void scatter(float* to, const std::uint32_t* at, const Lanes (&xyz)[3],
                                           const Lanes& w) {
    Lanes row[4];
    transpose(xyz, w, row);
    for (int l = 0; l < 4; ++l) {
        put(__builtin_shufflevector(row[l], row[l], 0, 1, 2, 3), to + at[l]);
        put(__builtin_shufflevector(row[l], row[l], 4, 5, 6, 7), to + at[l + 4]);
    }
}

/// As scatter, but adds. No place may occur twice.
[[gnu::always_inline]] inline void scatter_add(float* to, const std::uint32_t* at, const Lanes (&xyz)[3],
                                               const Lanes& w) {
    Lanes row[4];
    transpose(xyz, w, row);
    for (int l = 0; l < 4; ++l) {
        put(four(to + at[l]) + __builtin_shufflevector(row[l], row[l], 0, 1, 2, 3), to + at[l]);
        put(four(to + at[l + 4]) + __builtin_shufflevector(row[l], row[l], 4, 5, 6, 7), to + at[l + 4]);
    }
}

#if defined(__x86_64__)
[[nodiscard]] inline bool has_avx2() {
    return __builtin_cpu_supports("avx2");
}
#else
[[nodiscard]] inline bool has_avx2() {
    return false;
}
#endif

}  // namespace eti::pbd
