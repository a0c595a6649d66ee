// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"
#include "common/model/tools.hpp"

namespace eti {

/// The plate of a straight blade in the tool's frame, as drawn and as tissue gives way to it: how wide it is
/// and how high its contact face lies above the axis.
struct BladePlate {
    float length = 0.0f;               ///< [m], handle to tip
    float wide = 0.0f, narrow = 0.0f;  ///< [m], at the heel and before the tip
    float high = 0.0f, low = 0.0f;     ///< [m], the crown there
    float crown = 0.0f;                ///< [m], by how much the edges at the heel lie lower than the crown

    [[nodiscard]] float width(float along) const;
    [[nodiscard]] float height(float along) const;
};

[[nodiscard]] BladePlate plate_of(const Laryngoscope& scope);

/// How what is drawn of the tissue gives way to the blade. Particles that the blade keeps off are as far
/// apart as they are large, and what is skinned to them crosses its contact face here and there by a
/// millimetre or two. What lies on that side, or is no deeper in than `deepest`, goes out along the blade's
/// +y until it is `clearance` before the face; it comes to that smoothly over `softness`. Farther in is what
/// lies behind the plate, which stays (docs/decisions/0096-drawn-tissue-gives-way.md).
/// client/render/give_way_shader.hpp says the same to a graphics card.
struct GiveWay {
    static constexpr float clearance = 0.2e-3f;  ///< [m]
    static constexpr float softness = 0.8e-3f;   ///< [m], half the height over which it sets in
    static constexpr float deepest = 3.0e-3f;    ///< [m]
    static constexpr float release = 2.0e-3f;    ///< [m], beyond the deepest, until nothing moves
    static constexpr float beside = 3.0e-3f;     ///< [m], from the plate's edge and tip, until nothing moves
    static constexpr float heel = 12.0e-3f;      ///< [m] along the blade, where the plate begins

    BladePlate plate;

    /// No point goes farther [m].
    static constexpr float most = deepest + release + clearance;

    /// Whether any point within `radius` [m] of `centre` may move; tool frame.
    [[nodiscard]] bool moves(const Vec3f& centre, float radius) const;

    /// Tool frame.
    [[nodiscard]] Vec3f operator()(const Vec3f& point) const;
    /// Any frame, in which the tool has that pose.
    [[nodiscard]] Vec3f operator()(const Vec3f& point, const RigidTransform& tool) const {
        return tool * (*this)(tool.inverse() * point);
    }
};

}  // namespace eti
