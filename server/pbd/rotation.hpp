// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::pbd {

/// Columns of the rotation that a quaternion x, y, z, w of any length but zero stands for.
template <class T>
[[gnu::always_inline]] inline void columns_of(const T (&q)[4], T (&r)[3][3]) {
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

/// Turns the quaternion `q` (x, y, z, w) towards the rotation of the polar decomposition of the matrix with
/// columns `a` (Müller, Bender, Chentanez & Macklin 2016, "A robust method to extract the rotational part
/// of deformations"). Always a proper rotation, also for singular or inverted `a`. Its length grows by less
/// than a third a step; normalise it now and then. For any T with the arithmetic of numbers, as
/// neo_hookean.hpp: no square root, so all give the same bits.
template <class T>
[[gnu::always_inline]] inline void turn_towards(const T (&a)[3][3], T (&q)[4], int steps) {
    const T none{};
    const auto raise = [&](T& largest, const T& x) {  // to the magnitude of x
        largest = x > largest ? x : largest;
        largest = -x > largest ? -x : largest;
    };
    for (int step = 0; step < steps; ++step) {
        T r[3][3];
        columns_of(q, r);
        T turn[3] = {none, none, none};
        T trace = none;
        for (int c = 0; c < 3; ++c) {
            turn[0] += r[c][1] * a[c][2] - r[c][2] * a[c][1];
            turn[1] += r[c][2] * a[c][0] - r[c][0] * a[c][2];
            turn[2] += r[c][0] * a[c][1] - r[c][1] * a[c][0];
            trace += r[c][0] * a[c][0] + r[c][1] * a[c][1] + r[c][2] * a[c][2];
        }
        // Near the solution `turn` is (s_i + s_j) / (s_1 + s_2 + s_3) of the angle left, for principal
        // stretches s: two thirds where they are equal. Three halves of it converge five times a step
        // for stretches of 0.7 to 1.3, and still converge (rate 1/2) for flat and linear clusters. An
        // inverted or flat cluster can ask for more than a radian about an axis; bounded steps converge too.
        T wanted = none;
        raise(wanted, trace);
        wanted += 1e-20f;
        T longest = none;
        for (const T& part : turn) {
            raise(longest, part);
        }
        // A turn of less than this [rad] moves a cluster's rim by less than a float of its position tells.
        constexpr float smallest = 1e-6f;
        T least = 1.5f * longest;
        raise(least, wanted);
        const T half = longest > smallest * wanted ? 0.75f / least : none;
        // Quaternion (1, omega / 2): turns by 2 atan(|omega| / 2), the same for small steps, without a sine.
        const T ox = half * turn[0], oy = half * turn[1], oz = half * turn[2];
        const T x = q[0], y = q[1], z = q[2], w = q[3];
        q[0] = x + ox * w + oy * z - oz * y;
        q[1] = y + oy * w + oz * x - ox * z;
        q[2] = z + oz * w + ox * y - oy * x;
        q[3] = w - ox * x - oy * y - oz * z;
    }
}

}  // namespace eti::pbd
