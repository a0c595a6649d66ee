// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/model/landmark.hpp"

namespace eti {

/// Fingers hold the lips back for the person who looks into the mouth. Points in front of the upper gum, as
/// seen from the eye, move off the line of sight: upper lip and nose down in the image, lower lip and chin
/// up. Both the image and the measured view of the glottis use retracted lips; the simulated lips do not
/// move.
/// The shader client/render/shaders/scene/mesh_vertex.glsl computes the same.
struct LipRetraction {
    /// Skin gathers over this length [m] beyond a lip's edge, and a lip moves by at most `most`. `most` is
    /// less than two thirds of `gather`, since the smoothstep's largest slope is 1.5; skin never folds over.
    static constexpr float gather = 0.030f, most = 0.018f;
    /// Where the motion begins and is complete, from the gum towards the eye [m]. The range is close enough
    /// to a lip's edge that the edge moves with the lip, and wide enough that no sheet stretches between gum
    /// and lip.
    static constexpr float begins = -0.5e-3f, complete = 5.5e-3f;
    /// A finger's breadth: twice the sideways variance [m^2].
    static constexpr float breadth = 4e-4f;

    Mat3f axes = Mat3f::Identity();  ///< rows: right, up and towards the eye, as seen looking at the glottis
    Vec3f origin = Vec3f::Zero();    ///< [m], of these axes: on the line of sight, level with the upper gum
    float upper_shift = 0.0f;        ///< [m], downwards
    float lower_shift = 0.0f;        ///< [m], upwards
    float upper_edge = 0.0f;         ///< [m], the upper lip's edge along the second axis
    float lower_edge = 0.0f;

    /// The retracted position of a point [m] of the patient.
    [[nodiscard]] Vec3f retract_lips(const Vec3f& point) const;
    /// Largest displacement of any point [m].
    [[nodiscard]] float reach() const { return upper_shift > lower_shift ? upper_shift : lower_shift; }
    /// Whether any point within `radius` [m] of `centre` may move.
    [[nodiscard]] bool moves(const Vec3f& centre, float radius) const;
};

/// `eye` [m], patient frame. Lips move just past the gums, wherever the eye is; an eye at the glottis leaves
/// them.
[[nodiscard]] LipRetraction lip_retraction(const Vec3f& eye, const Landmarks& now);

}  // namespace eti
