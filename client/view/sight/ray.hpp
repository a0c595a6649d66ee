// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>

#include "common/math/transform.hpp"

namespace eti::view {

/// A segment [m] that is shortened to each triangle it hits.
class Ray {
  public:
    Ray(const Vec3f& from, const Vec3f& to) : from_(from), direction_(to - from) { set_reach(1.0f); }

    /// Whether the triangle is hit before all others so far (Moeller & Trumbore 1997). `front_only`:
    /// ignores back faces, whose corners appear clockwise.
    bool intersects(const Vec3f& a, const Vec3f& b, const Vec3f& c, bool front_only = false) {
        for (int axis = 0; axis < 3; ++axis) {
            if (std::max({a[axis], b[axis], c[axis]}) < low_[axis] ||
                std::min({a[axis], b[axis], c[axis]}) > high_[axis]) {
                return false;
            }
        }
        const Vec3f ab = b - a, ac = c - a, p = direction_.cross(ac);
        const float determinant = ab.dot(p);
        if (determinant == 0.0f || (front_only && determinant < 0.0f)) {
            return false;
        }
        const Vec3f s = from_ - a, q = s.cross(ab);
        const float u = s.dot(p) / determinant, v = direction_.dot(q) / determinant;
        const float reach = ac.dot(q) / determinant;
        if (!(u >= 0.0f && v >= 0.0f && u + v <= 1.0f && reach >= 0.0f && reach < reach_)) {
            return false;
        }
        u_ = u;
        v_ = v;
        set_reach(reach);
        return true;
    }

    [[nodiscard]] Vec3f end() const { return from_ + reach_ * direction_; }
    /// Barycentric coordinates of the last hit: a + u (b - a) + v (c - a).
    [[nodiscard]] float u() const { return u_; }
    [[nodiscard]] float v() const { return v_; }

  private:
    void set_reach(float reach) {
        reach_ = reach;
        low_ = from_.cwiseMin(end());
        high_ = from_.cwiseMax(end());
    }

    Vec3f from_, direction_;
    float reach_ = 1.0f;  // fraction of the segment
    float u_ = 0.0f, v_ = 0.0f;
    Vec3f low_, high_;
};

}  // namespace eti::view
