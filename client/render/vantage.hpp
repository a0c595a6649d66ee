// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/camera.hpp"
#include "client/view/trainee_eye.hpp"

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

/// What whoever sits before the pictures has moved: by mouse, keys and options. Views draw from it.
struct Vantage {
    Orbit orbit{};           ///< of the onlooker
    CutPlane cut{};          ///< of the section
    view::TraineeEye eye{};  ///< the trainee's own
};

}  // namespace eti::render
