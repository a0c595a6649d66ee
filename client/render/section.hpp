// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include "common/math/transform.hpp"
#include "common/math/units.hpp"
#include "common/model/landmark.hpp"

namespace eti::render {

/// A plane through the patient; what lies on the side to which `normal` points is taken away.
struct CutPlane {
    Vec3f origin = Vec3f::Zero();   ///< [m], patient frame
    Vec3f normal = Vec3f::UnitX();  ///< unit; by default the patient's left half is taken away

    /// (xyz, w) with dot(xyz, p) + w >= 0 for what stays.
    [[nodiscard]] Eigen::Vector4f kept() const {
        return {-normal.x(), -normal.y(), -normal.z(), normal.dot(origin)};
    }
};

/// Where the patient is cut: along the middle until somebody moves it. The plane turns about a point of the
/// airway between mouth and glottis.
class Section {
  public:
    static constexpr float farthest = 0.10f;  ///< [m], from that point
    static constexpr float most_tilt = 90.0f * degree;

    Section() = default;
    /// `offset` [m] towards the side that is taken away; `turn` [rad] about the patient's back-to-front axis,
    /// `tilt` [rad] about the long axis; offset and tilt are held within their limits.
    Section(float offset, float turn, float tilt);

    void shift(float by);                 ///< [m]
    void rotate(float turn, float tilt);  ///< [rad]

    [[nodiscard]] CutPlane plane(const Landmarks& now) const;
    /// What the patient's front is then: up in the section's picture.
    [[nodiscard]] Vec3f up() const;

    friend bool operator==(const Section&, const Section&) = default;

  private:
    [[nodiscard]] Mat3f rotation() const;

    float offset_ = 0.0f, turn_ = 0.0f, tilt_ = 0.0f;
};

}  // namespace eti::render
