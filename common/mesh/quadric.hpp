// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>

#include "common/math/transform.hpp"

namespace eti {

/// Weighted sum of squared distances to planes: x'Ax + 2 b'x + c.
struct Quadric {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    Vec3d b = Vec3d::Zero();
    double c = 0;

    void add_plane(const Vec3d& normal, double offset, double weight) {
        xx += weight * normal.x() * normal.x();
        xy += weight * normal.x() * normal.y();
        xz += weight * normal.x() * normal.z();
        yy += weight * normal.y() * normal.y();
        yz += weight * normal.y() * normal.z();
        zz += weight * normal.z() * normal.z();
        b += weight * offset * normal;
        c += weight * offset * offset;
    }

    Quadric& operator+=(const Quadric& o) {
        xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
        b += o.b;
        c += o.c;
        return *this;
    }

    [[nodiscard]] double trace() const { return xx + yy + zz; }

    [[nodiscard]] Vec3d times(const Vec3d& x) const {
        return {xx * x.x() + xy * x.y() + xz * x.z(), xy * x.x() + yy * x.y() + yz * x.z(),
                xz * x.x() + yz * x.y() + zz * x.z()};
    }

    [[nodiscard]] double at(const Vec3d& x) const { return std::max(0.0, x.dot(times(x) + 2.0 * b) + c); }

    /// The minimum, regularised towards `anchor` along directions that the planes leave undetermined.
    [[nodiscard]] Vec3d minimum(const Vec3d& anchor) const {
        // A hundredth of the trace moves the point by a hundredth of the distance between anchor and surface,
        // and keeps the system well conditioned on flat regions.
        const double pull = 1e-2 * trace();
        const double a00 = xx + pull, a11 = yy + pull, a22 = zz + pull;
        const double m00 = a11 * a22 - yz * yz, m01 = xz * yz - xy * a22, m02 = xy * yz - xz * a11;
        const double determinant = a00 * m00 + xy * m01 + xz * m02;
        if (!(determinant > 0.0)) {
            return anchor;
        }
        const double m11 = a00 * a22 - xz * xz, m12 = xy * xz - a00 * yz, m22 = a00 * a11 - xy * xy;
        const Vec3d r = -(times(anchor) + b);
        return anchor + Vec3d(m00 * r.x() + m01 * r.y() + m02 * r.z(),
                              m01 * r.x() + m11 * r.y() + m12 * r.z(),
                              m02 * r.x() + m12 * r.y() + m22 * r.z()) /
                            determinant;
    }
};

}  // namespace eti
