// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "client/view/scene_view.hpp"

namespace eti::panel {

/// A value over the last minute.
struct Series {
    struct Sample {
        double time_s;  ///< simulation time
        float value;    ///< as shown
    };
    const LiveMeasureField* field;
    std::deque<Sample> samples{};

    [[nodiscard]] float high() const;
    [[nodiscard]] float low() const;
};

/// The plotted series: the live measures that are plotted, then the server's load.
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
    std::vector<Series> series_;
    double newest_s_ = -1.0;
};

}  // namespace eti::panel
