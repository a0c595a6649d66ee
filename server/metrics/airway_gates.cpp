// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/metrics/airway_gates.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/thresholds.hpp"
#include "server/patient/model/patient.hpp"

namespace eti::metrics {
namespace {

constexpr std::size_t skull = static_cast<std::size_t>(patient::Bone::skull);

Vec3f unit_or(const Vec3f& v, const Vec3f& otherwise) {
    const float norm = v.norm();
    return norm > 1e-6f ? Vec3f(v / norm) : otherwise;
}

struct Foot {
    float along = 0.0f;     // [m] from the segment's start
    float distance = 0.0f;  // [m]
};

Foot foot_on(const Vec3f& point, const Vec3f& from, const Vec3f& to, bool endless) {
    const Vec3f direction = unit_or(to - from, Vec3f::UnitZ());
    const float upper = endless ? INFINITY : (to - from).norm();
    const float along = std::clamp(direction.dot(point - from), 0.0f, upper);
    return {along, (point - from - along * direction).norm()};
}

}  // namespace

Quatf skull_rotation(const scene::Snapshot& snapshot) {
    return skull < snapshot.frames.size() ? snapshot.frames[skull].rotation : Quatf(Quatf::Identity());
}

AirwayGates airway_gates(const scene::Snapshot& snapshot) {
    const Landmarks& points = snapshot.landmarks;
    const Vec3f left = Vec3f::UnitX();
    AirwayGates places;

    places.mouth.centre = at(points, Landmark::mouth_opening);
    const Vec3f posterior = skull_rotation(snapshot) * Vec3f::UnitY();
    const Vec3f gape = at(points, Landmark::upper_lip) - at(points, Landmark::lower_lip);
    places.mouth.onward =
        gape.norm() > threshold::lips_apart.as_float() ? unit_or(gape.cross(left), posterior) : posterior;
    if (places.mouth.past(at(points, Landmark::tongue_dorsum)) < 0.0f) {
        places.mouth.onward = -places.mouth.onward;
    }

    places.trachea_mid = at(points, Landmark::trachea_mid);
    places.carina = at(points, Landmark::carina);
    places.glottis.centre = at(points, Landmark::glottis);
    const Vec3f down = unit_or(places.trachea_mid - places.glottis.centre, -Vec3f::UnitZ());
    const Vec3f across = at(points, Landmark::glottis_anterior) - at(points, Landmark::glottis_posterior);
    places.glottis.onward = unit_or(across.cross(left), down);
    if (places.glottis.onward.dot(down) < 0.0f) {
        places.glottis.onward = -places.glottis.onward;
    }

    places.oesophagus_mid = at(points, Landmark::oesophagus_mid);
    places.oesophagus.centre = at(points, Landmark::oesophagus_inlet);
    places.oesophagus.onward = unit_or(places.oesophagus_mid - places.oesophagus.centre, -Vec3f::UnitZ());
    return places;
}

float AirwayGates::from_trachea(const Vec3f& point) const {
    return std::min(foot_on(point, glottis.centre, trachea_mid, false).distance,
                    foot_on(point, trachea_mid, carina, true).distance);
}

float AirwayGates::from_oesophagus(const Vec3f& point) const {
    return foot_on(point, oesophagus.centre, oesophagus_mid, true).distance;
}

float AirwayGates::trachea_length() const {
    return (trachea_mid - glottis.centre).norm() + (carina - trachea_mid).norm();
}

float AirwayGates::along_trachea(const Vec3f& point) const {
    if (glottis.past(point) < 0.0f) {
        return -(point - glottis.centre).norm();
    }
    const Foot upper = foot_on(point, glottis.centre, trachea_mid, false);
    const Foot lower = foot_on(point, trachea_mid, carina, true);
    return upper.distance < lower.distance ? upper.along
                                           : (trachea_mid - glottis.centre).norm() + lower.along;
}

std::optional<float> depth_at_lip(std::span<const Vec3f> tube_nodes, const Gate& mouth) {
    if (tube_nodes.empty() || mouth.past(tube_nodes.back()) < 0.0f) {
        return std::nullopt;
    }
    float length = 0.0f;
    for (std::size_t i = tube_nodes.size() - 1; i > 0; --i) {
        const float inside = mouth.past(tube_nodes[i]);
        const float next = mouth.past(tube_nodes[i - 1]);
        const float span = (tube_nodes[i] - tube_nodes[i - 1]).norm();
        if (next < 0.0f) {
            return length + span * inside / (inside - next);
        }
        length += span;
    }
    return length;
}

BladeAngles blade_angles(const scene::Snapshot& snapshot) {
    const Quatf to_skull = skull_rotation(snapshot).conjugate();
    const Vec3d direction = (to_skull * (snapshot.proxy.rotation * Vec3f::UnitZ())).cast<double>();
    return {std::atan2(-direction.z(), direction.y()), std::asin(std::clamp(direction.x(), -1.0, 1.0))};
}

}  // namespace eti::metrics
