// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <vector>

#include "common/model/landmark.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::metrics::test {

/// Landmarks of a simple airway: the mouth opens along +y (posterior), the trachea runs down -z.
inline Landmarks plain_landmarks() {
    Landmarks points;
    points.fill(Vec3f::Zero());
    const auto set = [&](Landmark which, float x, float y, float z) {
        points[static_cast<std::size_t>(which)] = Vec3f(x, y, z);
    };
    set(Landmark::upper_gum, 0, 0, 0);
    set(Landmark::lower_gum, 0, 0, -0.02f);
    set(Landmark::upper_lip, 0, -0.01f, 0);
    set(Landmark::lower_lip, 0, -0.01f, -0.02f);
    set(Landmark::mouth_opening, 0, -0.01f, -0.01f);
    set(Landmark::tongue_dorsum, 0, 0.02f, -0.02f);
    set(Landmark::vallecula, 0, 0.03f, -0.05f);
    set(Landmark::glottis, 0, 0.035f, -0.06f);
    set(Landmark::glottis_anterior, 0, 0.032f, -0.06f);
    set(Landmark::glottis_posterior, 0, 0.038f, -0.06f);
    set(Landmark::trachea_mid, 0, 0.035f, -0.085f);
    set(Landmark::carina, 0, 0.035f, -0.11f);
    set(Landmark::oesophagus_inlet, 0, 0.047f, -0.065f);
    set(Landmark::oesophagus_mid, 0, 0.047f, -0.085f);
    return points;
}

inline scene::Snapshot plain_snapshot() {
    scene::Snapshot snapshot;
    snapshot.landmarks = plain_landmarks();
    snapshot.frames.resize(patient::bone_count);
    snapshot.proxy.translation = Vec3f(0, -0.5f, 0);
    return snapshot;
}

/// A polyline, evaluated by arc length; extrapolated straight beyond its ends.
struct Path {
    std::vector<Vec3f> points;

    [[nodiscard]] Vec3f at(float length) const {
        std::size_t i = 1;
        while (i + 1 < points.size() && length > (points[i] - points[i - 1]).norm()) {
            length -= (points[i] - points[i - 1]).norm();
            ++i;
        }
        return points[i - 1] + length * (points[i] - points[i - 1]).normalized();
    }
    [[nodiscard]] float length_to(std::size_t corner) const {
        float length = 0.0f;
        for (std::size_t i = 1; i <= corner; ++i) {
            length += (points[i] - points[i - 1]).norm();
        }
        return length;
    }
};

/// From in front of the face through mouth and glottis down the trachea.
inline Path tracheal_path() {
    const Landmarks p = plain_landmarks();
    return {{Vec3f(0, -0.16f, -0.01f), at(p, Landmark::mouth_opening), at(p, Landmark::glottis),
             at(p, Landmark::trachea_mid), at(p, Landmark::carina)}};
}

inline Path oesophageal_path() {
    const Landmarks p = plain_landmarks();
    return {{Vec3f(0, -0.16f, -0.01f), at(p, Landmark::mouth_opening), at(p, Landmark::oesophagus_inlet),
             at(p, Landmark::oesophagus_mid)}};
}

/// Centre line of a tube of 0.15 m whose tip lies `tip` [m] along the path.
inline std::vector<Vec3f> tube_on(const Path& path, float tip) {
    std::vector<Vec3f> nodes;
    for (int i = 0; i <= 300; ++i) {
        nodes.push_back(path.at(tip - 0.15f + 0.0005f * static_cast<float>(i)));
    }
    return nodes;
}

}  // namespace eti::metrics::test
