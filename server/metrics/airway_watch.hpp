// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>

#include "common/math/transform.hpp"
#include "server/metrics/airway_gates.hpp"

namespace eti::metrics {

/// Location of the tube's tip.
enum class TubePlace : std::uint8_t { outside, mouth, trachea, main_stem, oesophagus };

/// Whether a point is past a gate, with hysteresis, so that a trembling tip counts once.
class GateTracker {
  public:
    enum class Change : unsigned char { none, in, out };

    /// `past` [m]; `in_reach`: the point is close enough to the gate for a crossing to count; `still_there`:
    /// it is still in the region behind the gate.
    Change update(float past, bool in_reach, bool still_there, float slack);
    [[nodiscard]] bool inside() const { return inside_; }

  private:
    bool inside_ = false;
};

/// Tracks the tube's tip through mouth, glottis, carina and oesophageal inlet.
class AirwayWatch {
  public:
    struct Changes {
        GateTracker::Change mouth = GateTracker::Change::none;
        GateTracker::Change trachea = GateTracker::Change::none;
        GateTracker::Change oesophagus = GateTracker::Change::none;
        GateTracker::Change main_stem = GateTracker::Change::none;
    };

    Changes update(const Vec3f& tip, const AirwayGates& places);

    [[nodiscard]] bool in_mouth() const { return mouth_.inside(); }
    [[nodiscard]] bool in_trachea() const { return trachea_.inside(); }
    [[nodiscard]] bool in_oesophagus() const { return oesophagus_.inside(); }
    [[nodiscard]] bool in_main_stem() const { return main_stem_.inside(); }
    [[nodiscard]] TubePlace place() const;
    /// [m], distance past the glottis along the trachea; minus the distance from the glottis before it is
    /// passed.
    [[nodiscard]] float past_glottis() const { return past_glottis_; }

  private:
    GateTracker mouth_, trachea_, oesophagus_, main_stem_;
    float past_glottis_ = -1.0f;
};

}  // namespace eti::metrics
