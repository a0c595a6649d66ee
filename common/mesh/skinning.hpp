// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/transform.hpp"
#include "common/math/units.hpp"

namespace eti {

/// Pose of a frame (a bone or a shape-matching cluster). A rest point x0 with full weight on the frame moves
/// to rotation * (x0 - rest_centre) + centre.
struct FramePose {
    Vec3f centre = Vec3f::Zero();        ///< [m], patient frame
    Quatf rotation = Quatf::Identity();  ///< rest to current
};

/// A frame that moved by less than this since it was last sent or recorded counts as unmoved: a tenth of what
/// is visible.
inline constexpr float frame_shift_quantum = 0.02e-3f;       ///< [m]
inline constexpr float frame_turn_quantum = 0.05f * degree;  ///< [rad]

/// Whether a frame has moved by more than these limits; true if a number is not finite.
[[nodiscard]] inline bool has_moved(const FramePose& from, const FramePose& to) {
    return !((to.centre - from.centre).norm() <= frame_shift_quantum) ||
           !(rotation_vector(from.rotation.conjugate() * to.rotation).norm() <= frame_turn_quantum);
}

/// A frame's transform of rest points as matrix and offset. A matrix costs nine products per point, a
/// quaternion twice that, and each frame carries many points.
struct FrameMap {
    Mat3f linear = Mat3f::Identity();
    Vec3f offset = Vec3f::Zero();

    [[nodiscard]] Vec3f operator*(const Vec3f& rest) const { return linear * rest + offset; }
};

[[nodiscard]] inline FrameMap frame_map(const FramePose& pose, const Vec3f& rest_centre) {
    FrameMap map;
    map.linear = pose.rotation.toRotationMatrix();
    map.offset = pose.centre - map.linear * rest_centre;
    return map;
}

/// Maximum number of frames per point. With fewer, neighbouring points drop different frames, which tears the
/// surface (docs/decisions/skinning.md).
inline constexpr std::size_t frames_per_point = 8;

/// The frames of a point, with weights that sum to one; unused entries weigh zero.
struct SkinWeights {
    std::array<std::uint16_t, frames_per_point> frame{};
    std::array<float, frames_per_point> weight{};
};

/// Linear blend skinning of one rest point [m].
[[nodiscard]] inline Vec3f skin_point(const Vec3f& rest, const SkinWeights& weights,
                                      std::span<const FrameMap> frames) {
    Vec3f sum = Vec3f::Zero();
    for (std::size_t k = 0; k < frames_per_point; ++k) {
        if (weights.weight[k] > 0.0f) {
            sum += weights.weight[k] * (frames[weights.frame[k]] * rest);
        }
    }
    return sum;
}

/// As above, for frames that carry few points each.
[[nodiscard]] inline Vec3f skin_point(const Vec3f& rest, const SkinWeights& weights,
                                      std::span<const Vec3f> rest_centres,
                                      std::span<const FramePose> frames) {
    Vec3f sum = Vec3f::Zero();
    for (std::size_t k = 0; k < frames_per_point; ++k) {
        if (weights.weight[k] > 0.0f) {
            const FramePose& frame = frames[weights.frame[k]];
            sum +=
                weights.weight[k] * (frame.rotation * (rest - rest_centres[weights.frame[k]]) + frame.centre);
        }
    }
    return sum;
}

}  // namespace eti
