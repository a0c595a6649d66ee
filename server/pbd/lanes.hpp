// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace eti::pbd {

// Eight floats processed together by a kernel. The compiler maps them to the available instruction set with
// bit-identical results (no fused operations). A kernel is inlined into one function for the baseline and one
// for AVX2; has_avx2() says which to call.

// To the compiler, a store of lanes may alias anything, including a vector's data pointer. Loops that store
// therefore keep local copies of pointers.

using Float4 = float __attribute__((vector_size(16)));
using Lanes = float __attribute__((vector_size(32)));
inline constexpr std::size_t lane_count = 8;
static_assert(sizeof(Eigen::Vector4f) == sizeof(Float4));

[[gnu::always_inline]] inline void load(const float* from, Lanes& to) {
    std::memcpy(&to, from, sizeof to);
}

[[gnu::always_inline]] inline void store(const Lanes& from, float* to) {
    std::memcpy(to, &from, sizeof from);
}

[[nodiscard]] [[gnu::always_inline]] inline Float4 load_float4(const float* from) {
    Float4 out;
    std::memcpy(&out, from, sizeof out);
    return out;
}
[[nodiscard]] [[gnu::always_inline]] inline Float4 load_float4(const Eigen::Vector4f& from) {
    return load_float4(from.data());
}

[[gnu::always_inline]] inline void put(const Float4& from, float* to) {
    std::memcpy(to, &from, sizeof from);
}
[[gnu::always_inline]] inline void put(const Float4& from, Eigen::Vector4f& to) {
    put(from, to.data());
}

/// Correctly rounded square roots, hence bit-identical on every instruction set. One instruction where
/// sources are compiled with -fno-math-errno.
[[gnu::always_inline]] inline void sqrt_in_place(Lanes& of) {
    for (std::size_t l = 0; l < lane_count; ++l) {
        of[l] = std::sqrt(of[l]);
    }
}

/// Gathers eight vectors x, y, z, w that start at offsets `at` in `from`, one per lane: an 8 x 4
/// transposition.
[[gnu::always_inline]] inline void gather(const float* from, const std::uint32_t* at, Lanes (&xyz)[3],
                                          Lanes& w) {
    Lanes row[4];  // vectors l and l + 4
    for (int l = 0; l < 4; ++l) {
        Float4 low;
        Float4 high;
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

/// The inverse: row l holds the vectors of lanes l and l + 4, for l from 0 to 3.
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

/// Like scatter(), but adds. Offsets must be distinct.
[[gnu::always_inline]] inline void scatter_add(float* to, const std::uint32_t* at, const Lanes (&xyz)[3],
                                               const Lanes& w) {
    Lanes row[4];
    transpose(xyz, w, row);
    for (int l = 0; l < 4; ++l) {
        put(load_float4(to + at[l]) + __builtin_shufflevector(row[l], row[l], 0, 1, 2, 3), to + at[l]);
        put(load_float4(to + at[l + 4]) + __builtin_shufflevector(row[l], row[l], 4, 5, 6, 7),
            to + at[l + 4]);
    }
}

/// Whether kernels run in their AVX2 form: where the processor has it, unless the environment variable
/// ETI_SIMD is "sse2". Read once per process.
[[nodiscard]] bool has_avx2();

}  // namespace eti::pbd
