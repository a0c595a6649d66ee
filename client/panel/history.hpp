// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <deque>
#include <span>
#include <string_view>

#include "client/view/scene_view.hpp"

namespace eti::panel {

/// A value over the last minute.
struct Series {
    struct Sample {
        double time_s;  ///< simulation time
        float value;
    };
    std::string_view label, unit;
    float min_high;      ///< minimum upper end of the scale
    bool negative;       ///< the scale reaches below 0
    float warning, bad;  ///< drawn as lines; NaN: none
    std::deque<Sample> samples{};

    [[nodiscard]] float high() const;
    [[nodiscard]] float low() const;
};

/// The plotted series: gum force, glottic opening, tube depth, load.
class History {
  public:
    static constexpr double span_s = 60.0;

    History();
    /// Samples each series when the server publishes new metrics; clears all when simulation time restarts.
    void follow(const view::SceneView& scene);
    [[nodiscard]] std::span<const Series> series() const { return series_; }
    /// Time of the newest sample [s].
    [[nodiscard]] double newest_s() const { return newest_s_; }

  private:
    std::array<Series, 4> series_;
    double newest_s_ = -1.0;
};

}  // namespace eti::panel
