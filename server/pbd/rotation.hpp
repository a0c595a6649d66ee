// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::pbd {

/// Columns of the rotation of a quaternion x, y, z, w of any non-zero length.
template <class T>
[[gnu::always_inline]] inline void rotation_columns(const T (&q)[4], T (&r)[3][3]) {
    const T two = 2.0f / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const T x = two * q[0], y = two * q[1], z = two * q[2];
    const T xx = x * q[0], yy = y * q[1], zz = z * q[2];
    const T xy = x * q[1], xz = x * q[2], yz = y * q[2];
    const T wx = x * q[3], wy = y * q[3], wz = z * q[3];
    const T one = T{} + 1.0f;
    r[0][0] = one - yy - zz;
    r[0][1] = xy + wz;
    r[0][2] = xz - wy;
    r[1][0] = xy - wz;
    r[1][1] = one - xx - zz;
    r[1][2] = yz + wx;
    r[2][0] = xz + wy;
    r[2][1] = yz - wx;
    r[2][2] = one - xx - yy;
}

/// Rotates the quaternion `q` (x, y, z, w) towards the rotation of the polar decomposition of the matrix with
/// columns `a` (Müller, Bender, Chentanez & Macklin 2016, "A robust method to extract the rotational part of
/// deformations"). Always a proper rotation, also for singular or inverted `a`. Its length grows by less than
/// a third per iteration; normalise it occasionally. Works for any T with arithmetic (see neo_hookean.hpp);
/// without square roots, so that all give identical bits.
template <class T>
[[gnu::always_inline]] inline void extract_rotation(const T (&a)[3][3], T (&q)[4], int steps) {
    const T none{};
    const auto raise = [&](T& largest, const T& x) {  // to the magnitude of x
        largest = x > largest ? x : largest;
        largest = -x > largest ? -x : largest;
    };
    for (int step = 0; step < steps; ++step) {
        T r[3][3];
        rotation_columns(q, r);
        T turn[3] = {none, none, none};
        T trace = none;
        for (int c = 0; c < 3; ++c) {
            turn[0] += r[c][1] * a[c][2] - r[c][2] * a[c][1];
            turn[1] += r[c][2] * a[c][0] - r[c][0] * a[c][2];
            turn[2] += r[c][0] * a[c][1] - r[c][1] * a[c][0];
            trace += r[c][0] * a[c][0] + r[c][1] * a[c][1] + r[c][2] * a[c][2];
        }
        // Near the solution `turn` is (s_i + s_j) / (s_1 + s_2 + s_3) times the remaining angle, for
        // principal stretches s: two thirds where they are equal. Three halves of it gain a factor of five
        // per iteration for stretches of 0.7 to 1.3, and still converge (rate 1/2) for flat and linear
        // clusters. An inverted or flat cluster can request more than a radian about an axis; bounded
        // iterations converge too.
        T wanted = none;
        raise(wanted, trace);
        wanted += 1e-20f;
        T longest = none;
        for (const T& part : turn) {
            raise(longest, part);
        }
        // A rotation below this [rad] moves a cluster's rim by less than a float of its position resolves.
        constexpr float smallest = 1e-6f;
        T least = 1.5f * longest;
        raise(least, wanted);
        const T half = longest > smallest * wanted ? 0.75f / least : none;
        // Quaternion (1, omega / 2): rotates by 2 atan(|omega| / 2), equal to omega for small steps, without
        // a sine.
        const T ox = half * turn[0], oy = half * turn[1], oz = half * turn[2];
        const T x = q[0], y = q[1], z = q[2], w = q[3];
        q[0] = x + ox * w + oy * z - oz * y;
        q[1] = y + oy * w + oz * x - ox * z;
        q[2] = z + oz * w + ox * y - oy * x;
        q[3] = w - ox * x - oy * y - oz * z;
    }
}

}  // namespace eti::pbd
