// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/model/landmark.hpp"

namespace eti {

/// Fingers hold the lips aside for whoever looks into the mouth. What lies before the upper gum, as the eye
/// sees it, moves off the line of sight: upper lip and nose down in the picture, lower lip and chin up. The
/// picture and the measured view of the glottis both look past lips held so; the simulated lips stay.
/// The shader held_aside() of client/render/mesh_shaders.hpp computes the same.
struct LipRetraction {
    /// Over this length [m] beyond a lip's edge skin gathers, and by `most` a lip gives way: less than two
    /// thirds of the former, the steepest slope of the step between, so that skin never folds over.
    static constexpr float gather = 0.030f, most = 0.018f;
    /// Where it begins and is complete, towards the eye from the gum [m]: so near to a lip's edge that this
    /// is held as the other is, and so far apart that gum and lip between them do not become a sheet.
    static constexpr float begins = -0.5e-3f, complete = 5.5e-3f;
    /// A finger's breadth: twice the variance [m^2] sideways.
    static constexpr float breadth = 4e-4f;

    Mat3f axes = Mat3f::Identity();  ///< rows: right, up and towards the eye, as one looks at the glottis
    Vec3f origin = Vec3f::Zero();    ///< [m], of these axes: on the line of sight, level with the upper gum
    float upper_shift = 0.0f;        ///< [m], downwards
    float lower_shift = 0.0f;        ///< [m], upwards
    float upper_edge = 0.0f;         ///< [m], the upper lip's edge along the second axis
    float lower_edge = 0.0f;

    /// Where a point [m] of the patient is then.
    [[nodiscard]] Vec3f held_aside(const Vec3f& point) const;
    /// [m], no point moves further.
    [[nodiscard]] float reach() const { return upper_shift > lower_shift ? upper_shift : lower_shift; }
    /// Whether any point within `radius` [m] of `centre` may move.
    [[nodiscard]] bool moves(const Vec3f& centre, float radius) const;
};

/// `eye` [m], patient frame. Lips go just past the gums, whatever the eye; an eye on the glottis leaves them.
[[nodiscard]] LipRetraction lip_retraction(const Vec3f& eye, const Landmarks& now);

}  // namespace eti
