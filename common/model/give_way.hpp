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
    static constexpr float deepest = 2.5e-3f;    ///< [m], what comes out wholly
    static constexpr float release = 3.0e-3f;    ///< [m], beyond the deepest, until nothing moves
    static constexpr float beside = 4.0e-3f;     ///< [m], from the plate's edge and tip, until nothing moves
    static constexpr float heel = 12.0e-3f;      ///< [m] along the blade, where the plate begins

    BladePlate plate;

    /// No point goes farther [m]: of (deepest + t release) (1 - smoothstep(0, 1, t)) the most is 2.78 mm.
    static constexpr float most = 2.8e-3f;
    /// No edge of a surface becomes longer than this many times. In height the steepest is 2.7, half-way
    /// through the release; sideways and along the blade 1.5 most / beside = 1.05 of shear, where that is
    /// less.
    static constexpr float most_stretch = 3.0f;

    /// Whether any point within `radius` [m] of `centre` may move; tool frame.
    [[nodiscard]] bool moves(const Vec3f& centre, float radius) const;

    /// Tool frame.
    [[nodiscard]] Vec3f operator()(const Vec3f& point) const;
    /// Any frame, in which the tool has that pose.
    [[nodiscard]] Vec3f operator()(const Vec3f& point, const RigidTransform& tool) const {
        return tool * (*this)(tool.inverse() * point);
    }
};

/// The same of a blade that is held at a pose.
struct PlacedGiveWay {
    GiveWay give_way;
    RigidTransform tool;

    [[nodiscard]] Vec3f operator()(const Vec3f& point) const { return give_way(point, tool); }
    /// False when nothing in a ball gives way.
    [[nodiscard]] bool may_move(const Vec3f& centre, float radius) const;
};

}  // namespace eti
