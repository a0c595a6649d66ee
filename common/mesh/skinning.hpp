// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/transform.hpp"

namespace eti {

/// Pose of a frame (a bone or a shape-matching cluster). A rest point x0 that the frame carries
/// alone goes to rotation * (x0 - rest_centre) + centre.
struct FramePose {
    Vec3f centre = Vec3f::Zero();        ///< [m], patient frame
    Quatf rotation = Quatf::Identity();  ///< rest to current
};

/// Up to four frames that carry a point, with weights that sum to one; unused entries weigh zero.
struct SkinWeights {
    std::array<std::uint16_t, 4> frame{};
    std::array<float, 4> weight{};
};

/// Linear blend skinning of one rest point [m].
[[nodiscard]] inline Vec3f skin_point(const Vec3f& rest, const SkinWeights& weights,
                                      std::span<const Vec3f> rest_centres,
                                      std::span<const FramePose> frames) {
    Vec3f sum = Vec3f::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
        if (weights.weight[k] > 0.0f) {
            const FramePose& frame = frames[weights.frame[k]];
            sum +=
                weights.weight[k] * (frame.rotation * (rest - rest_centres[weights.frame[k]]) + frame.centre);
        }
    }
    return sum;
}

}  // namespace eti
