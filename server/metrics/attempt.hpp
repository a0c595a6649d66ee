// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <limits>

#include "common/model/attempt_metrics.hpp"
#include "common/model/run.hpp"
#include "server/metrics/airway_watch.hpp"
#include "server/metrics/glottic_view.hpp"
#include "server/metrics/signal.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::metrics {

/// Maximum and time-weighted mean.
class TimeMean {
  public:
    void add(double value, double seconds) {
        max_ = std::max(max_, value);
        sum_ += value * seconds;
        seconds_ += seconds;
    }
    /// NaN before the first sample.
    [[nodiscard]] double max() const { return max_ >= 0.0 ? max_ : std::numeric_limits<double>::quiet_NaN(); }
    [[nodiscard]] double mean() const {
        return seconds_ > 0.0 ? sum_ / seconds_ : std::numeric_limits<double>::quiet_NaN();
    }
    [[nodiscard]] double integral() const { return sum_; }
    [[nodiscard]] double seconds() const { return seconds_; }

  private:
    double max_ = -1.0;  // all quantities are non-negative
    double sum_ = 0.0;
    double seconds_ = 0.0;
};

/// Net forces [N] on tissues in one snapshot.
struct TissueForces {
    double gum = 0.0, epiglottis = 0.0, tongue = 0.0;
};

[[nodiscard]] TissueForces tissue_forces(const scene::Snapshot& snapshot);

/// All that an attempt needs of one snapshot; computed once per snapshot.
struct AttemptSample {
    double time = 0.0;     ///< [s] since the attempt began
    double seconds = 0.0;  ///< [s] since the previous snapshot
    TissueForces forces;
    Vec3f blade_tip = Vec3f::Zero();
    float blade_depth = 0.0f;  ///< [m], upper gum to blade tip
    BladeAngles angles;
    GlotticView view;
    bool tube_in_mouth = false;
    Vec3f tube_tip = Vec3f::Zero(), tube_grip = Vec3f::Zero();
    AirwayWatch::Changes tube;
    bool tube_at_glottis = false;
    float head_elevation = 0.0f;                                          ///< [rad]
    double depth_at_lip = std::numeric_limits<double>::quiet_NaN();       ///< [m]
    double oxygen_saturation = std::numeric_limits<double>::quiet_NaN();  ///< [%]; NaN unless simulated
    double heart_rate = std::numeric_limits<double>::quiet_NaN();         ///< [1/min]; NaN unless simulated
};

/// Speed [m/s] of a moving point over intervals of at least `interval` [s]. Differences between successive
/// steps would show solver noise as speed.
class SpeedMeter {
  public:
    explicit SpeedMeter(double interval) : interval_(interval) {}
    void restart() { started_ = false; }
    /// Returns true when an interval has been completed; `speed` and `seconds` then describe it.
    bool add(double time, const Vec3f& point);
    double speed = 0.0;
    double seconds = 0.0;

  private:
    double interval_;
    double since_ = 0.0;
    Vec3f from_ = Vec3f::Zero();
    bool started_ = false;
};

/// Metrics of one attempt, updated sample by sample.
class Attempt {
  public:
    Attempt(double weight_kg, double time_limit);

    void add(const AttemptSample& sample);

    /// Current values. Rocking and smoothness need the whole curve: they are those of the last
    /// refresh_curves().
    [[nodiscard]] const AttemptMetrics& metrics() const { return metrics_; }
    /// Computes rocking and smoothness; about 0.5 ms for an attempt of 30 s.
    void refresh_curves();

    [[nodiscard]] RunPart::Weights weights() const;
    [[nodiscard]] bool passed_glottis() const { return passed_glottis_; }
    [[nodiscard]] bool glottis_seen() const { return seen_; }
    [[nodiscard]] bool epiglottis_seen() const { return epiglottis_seen_; }

  private:
    void fill_means();

    double time_limit_;
    AttemptMetrics metrics_ = initial_metrics();
    TimeMean gum_, epiglottis_, tongue_, depth_, view_, tube_speed_, grip_speed_;
    double best_view_ = 0.0;
    double pitch_angle_ = 0.0;  // [rad]
    bool seen_ = false;
    bool epiglottis_seen_ = false;
    bool tube_reached_glottis_ = false;
    bool passed_glottis_ = false;
    PeakCounter pitch_peaks_, left_peaks_, right_peaks_;
    BinnedSeries pitch_, yaw_, blade_speed_;
    SpeedMeter tube_meter_, grip_meter_, blade_meter_;
};

/// Grade after Cormack & Lehane 1984 (Anaesthesia 39:1105) from the best view: 1 half or more of the glottis,
/// 2 part of it, 3 only the epiglottis, 4 neither.
[[nodiscard]] double cormack_lehane_grade(double best_opening_percent, bool epiglottis_seen);

}  // namespace eti::metrics
