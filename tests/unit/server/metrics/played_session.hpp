// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cmath>
#include <functional>

#include "airway_shapes.hpp"
#include "server/metrics/metrics.hpp"

namespace eti::metrics::test {

inline constexpr double step = 1.0 / 180.0;

/// Poses a blade whose tip lies `depth` [m] behind the plane of the mouth opening, on its axis.
inline void place_blade(scene::Snapshot& snapshot, const Laryngoscope& scope, float depth, float pitch = 0.0f,
                        float yaw = 0.0f) {
    const Vec3f direction(std::sin(yaw), std::cos(yaw) * std::cos(pitch), -std::cos(yaw) * std::sin(pitch));
    snapshot.proxy.rotation = Quatf::FromTwoVectors(Vec3f::UnitZ(), direction);
    const Vec3f tip = at(snapshot.landmarks, Landmark::mouth_opening) + Vec3f(0, depth, 0);
    snapshot.proxy.translation = tip - snapshot.proxy.rotation * scope.tip();
}

class Session {
  public:
    Session() {
        patient.weight = 3.0f;
        scope.blade_length = 0.1f;
        metrics.begin(patient, scope, 30.0);
    }

    /// Plays `seconds` of a motion; `pose` fills the snapshot and the view for a time since the start of the
    /// motion.
    void play(double seconds, const std::function<void(double, scene::Snapshot&, GlotticView&)>& pose) {
        const int steps = static_cast<int>(std::lround(seconds / step));
        for (int i = 0; i < steps; ++i, ++number) {
            snapshot.step = number;
            snapshot.time_ns =
                static_cast<std::uint64_t>(std::llround(static_cast<double>(number) * step * 1e9));
            pose(static_cast<double>(i) * step, snapshot, view);
            metrics.observe(snapshot, view);
        }
    }

    patient::Patient patient;
    Laryngoscope scope;
    scene::Snapshot snapshot = plain_snapshot();
    GlotticView view;
    Metrics metrics;
    std::uint64_t number = 900;  // a session that began five seconds before the run
};

}  // namespace eti::metrics::test
