// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <span>

#include "common/math/transform.hpp"
#include "common/model/landmark.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::metrics {

/// A plane with a normal; points on the normal's side are past the gate.
struct Gate {
    Vec3f centre = Vec3f::Zero();   ///< [m]
    Vec3f onward = Vec3f::UnitZ();  ///< unit normal
    /// Signed distance [m] of `point` past the plane.
    [[nodiscard]] float past(const Vec3f& point) const { return onward.dot(point - centre); }
    /// Distance [m] of `point` from the line through the centre along `onward`.
    [[nodiscard]] float radial_distance(const Vec3f& point) const {
        const Vec3f offset = point - centre;
        return (offset - onward.dot(offset) * onward).norm();
    }
};

/// The gates of mouth, glottis and oesophagus, and the airway's reference points [m], in one snapshot.
struct AirwayGates {
    Gate mouth;       ///< the opening between the lips; normal inwards
    Gate glottis;     ///< through the commissures and along the left-right axis; normal towards the trachea
    Gate oesophagus;  ///< the oesophageal inlet; normal towards the oesophagus
    Vec3f trachea_mid = Vec3f::Zero();
    Vec3f carina = Vec3f::Zero();
    Vec3f oesophagus_mid = Vec3f::Zero();

    /// Distances [m] from the polylines glottis - mid trachea - carina, and inlet - mid oesophagus (extended
    /// beyond its last point).
    [[nodiscard]] float from_trachea(const Vec3f& point) const;
    [[nodiscard]] float from_oesophagus(const Vec3f& point) const;

    /// Arc length [m] along glottis - mid trachea - carina (extended beyond it) to the foot of `point`;
    /// proximal to the glottis, minus the distance from its centre.
    [[nodiscard]] float along_trachea(const Vec3f& point) const;
    [[nodiscard]] float trachea_length() const;  ///< [m], glottis to carina
};

/// Rotation of the skull from rest, patient frame; the rest rotation where the snapshot has no frames.
[[nodiscard]] Quatf skull_rotation(const scene::Snapshot& snapshot);

[[nodiscard]] AirwayGates airway_gates(const scene::Snapshot& snapshot);

/// Length [m] of a tube's centre line from its last node back to where it leaves the mouth; empty when the
/// tip is not inside.
[[nodiscard]] std::optional<float> depth_at_lip(std::span<const Vec3f> tube_nodes, const Gate& mouth);

/// Direction of the blade in the skull frame.
struct BladeAngles {
    /// [rad] in the mid-sagittal plane: 0 when the blade points posterior (straight into the face), pi/2 when
    /// it points inferior; increases as the tip rises towards the handle.
    double pitch = 0.0;
    double yaw = 0.0;  ///< [rad] out of the mid-sagittal plane, positive to the patient's left
};

[[nodiscard]] BladeAngles blade_angles(const scene::Snapshot& snapshot);

}  // namespace eti::metrics
