// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include "common/math/transform.hpp"
#include "common/math/units.hpp"
#include "common/model/landmark.hpp"

namespace eti::render {

/// A section plane through the patient; the side to which `normal` points is removed.
struct CutPlane {
    Vec3f origin = Vec3f::Zero();   ///< [m], patient frame
    Vec3f normal = Vec3f::UnitX();  ///< unit; by default the patient's left half is removed

    /// (xyz, w) with dot(xyz, p) + w >= 0 for the half that is kept.
    [[nodiscard]] Eigen::Vector4f kept() const {
        return {-normal.x(), -normal.y(), -normal.z(), normal.dot(origin)};
    }
};

/// The section plane: midline by default. It rotates about a point of the airway between mouth and glottis.
class Section {
  public:
    static constexpr float max_offset = 0.10f;  ///< [m], from that point
    static constexpr float max_tilt = 90.0f * degree;

    Section() = default;
    /// `offset` [m] towards the removed side; `turn` [rad] about the patient's back-to-front axis, `tilt`
    /// [rad] about the long axis; offset and tilt are clamped to their limits.
    Section(float offset, float turn, float tilt);

    void shift(float by);                 ///< [m]
    void rotate(float turn, float tilt);  ///< [rad]

    [[nodiscard]] CutPlane plane(const Landmarks& now) const;
    /// Up direction of the section's picture: the patient's front.
    [[nodiscard]] Vec3f up() const;

    friend bool operator==(const Section&, const Section&) = default;

  private:
    [[nodiscard]] Mat3f rotation() const;

    float offset_ = 0.0f, turn_ = 0.0f, tilt_ = 0.0f;
};

}  // namespace eti::render
