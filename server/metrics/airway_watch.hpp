// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>

#include "common/math/transform.hpp"
#include "server/metrics/places.hpp"

namespace eti::metrics {

/// Where the tube's tip lies.
enum class TubePlace : std::uint8_t { outside, mouth, trachea, main_stem, oesophagus };

/// Whether a point is past a gate, with hysteresis: a trembling tip is counted once.
class Passage {
  public:
    enum class Change : unsigned char { none, in, out };

    /// `past` [m], whether the point is where the gate counts, and whether it still is where one gets
    /// to through the gate.
    Change update(float past, bool in_reach, bool still_there, float slack);
    [[nodiscard]] bool inside() const { return inside_; }

  private:
    bool inside_ = false;
};

/// Follows the tube's tip through mouth, glottis, carina and oesophageal inlet.
class AirwayWatch {
  public:
    struct Changes {
        Passage::Change mouth = Passage::Change::none;
        Passage::Change trachea = Passage::Change::none;
        Passage::Change oesophagus = Passage::Change::none;
        Passage::Change main_stem = Passage::Change::none;
    };

    Changes update(const Vec3f& tip, const Places& places);

    [[nodiscard]] bool in_mouth() const { return mouth_.inside(); }
    [[nodiscard]] bool in_trachea() const { return trachea_.inside(); }
    [[nodiscard]] bool in_oesophagus() const { return oesophagus_.inside(); }
    [[nodiscard]] bool in_main_stem() const { return main_stem_.inside(); }
    [[nodiscard]] TubePlace place() const;
    /// [m] past the glottis along the trachea; minus the distance from the glottis when not through it.
    [[nodiscard]] float past_glottis() const { return past_glottis_; }

  private:
    Passage mouth_, trachea_, oesophagus_, main_stem_;
    float past_glottis_ = -1.0f;
};

}  // namespace eti::metrics
