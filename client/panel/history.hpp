// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <deque>
#include <span>
#include <string_view>

#include "client/view/scene_view.hpp"

namespace eti::panel {

/// A number over the last minute.
struct Series {
    struct Sample {
        double time_s;  ///< simulation time
        float value;
    };
    std::string_view label, unit;
    float least_high;    ///< the scale reaches so far at least
    bool negative;       ///< the scale reaches below 0
    float warning, bad;  ///< drawn as lines; NaN: none
    std::deque<Sample> samples{};

    [[nodiscard]] float high() const;
    [[nodiscard]] float low() const;
};

/// What is plotted: gum force, glottic opening, tube depth, load.
class History {
  public:
    static constexpr double span_s = 60.0;

    History();
    /// Takes a sample of each where the server has measured anew; forgets all where time began anew.
    void follow(const view::SceneView& scene);
    [[nodiscard]] std::span<const Series> series() const { return series_; }
    /// Of the newest sample [s].
    [[nodiscard]] double newest_s() const { return newest_s_; }

  private:
    std::array<Series, 4> series_;
    double newest_s_ = -1.0;
};

}  // namespace eti::panel
