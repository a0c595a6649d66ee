// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <span>

#include "common/math/transform.hpp"
#include "common/model/landmark.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::metrics {

/// A plane with the direction that counts as past it.
struct Gate {
    Vec3f centre = Vec3f::Zero();   ///< [m]
    Vec3f onward = Vec3f::UnitZ();  ///< unit
    /// Signed distance [m] of `point` past the plane.
    [[nodiscard]] float past(const Vec3f& point) const { return onward.dot(point - centre); }
    /// Distance [m] of `point` from the line through the centre along `onward`.
    [[nodiscard]] float aside(const Vec3f& point) const {
        const Vec3f offset = point - centre;
        return (offset - onward.dot(offset) * onward).norm();
    }
};

/// Where the mouth, the glottis and the oesophagus are in one snapshot.
struct Places {
    Gate mouth;       ///< through the opening between the lips, inwards
    Gate glottis;     ///< through the commissures, across the left-right axis, towards the trachea
    Gate oesophagus;  ///< through the inlet, towards the oesophagus
    Vec3f trachea_mid = Vec3f::Zero();
    Vec3f carina = Vec3f::Zero();
    Vec3f oesophagus_mid = Vec3f::Zero();

    /// Distances [m] from the lines glottis - mid trachea - carina, and inlet - mid oesophagus
    /// (continued beyond its last point).
    [[nodiscard]] float from_trachea(const Vec3f& point) const;
    [[nodiscard]] float from_oesophagus(const Vec3f& point) const;

    /// Length [m] along glottis - mid trachea - carina (continued beyond) to the foot of `point`;
    /// before the glottis, minus the distance from its centre.
    [[nodiscard]] float along_trachea(const Vec3f& point) const;
    [[nodiscard]] float trachea_length() const;  ///< [m], glottis to carina
};

/// From rest, patient frame; that of a head at rest where there are no frames.
[[nodiscard]] Quatf skull_rotation(const scene::Snapshot& snapshot);

[[nodiscard]] Places places_in(const scene::Snapshot& snapshot);

/// Length [m] of a tube's centre line from its last node back to where it leaves the mouth; nothing
/// when its tip is not inside.
[[nodiscard]] std::optional<float> depth_at_lip(std::span<const Vec3f> tube_nodes, const Gate& mouth);

/// Direction of the blade in the skull frame.
struct BladeAngles {
    /// [rad] in the mid-sagittal plane: 0 when the blade points posterior (straight into a face), a
    /// quarter turn when it points inferior, growing as the tip rises towards the handle.
    double pitch = 0.0;
    double yaw = 0.0;  ///< [rad] out of the mid-sagittal plane, positive to the patient's left
};

[[nodiscard]] BladeAngles blade_angles(const scene::Snapshot& snapshot);

}  // namespace eti::metrics
