// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <limits>

#include "common/model/parameters.hpp"
#include "common/model/run.hpp"
#include "server/metrics/airway_watch.hpp"
#include "server/metrics/glottic_view.hpp"
#include "server/metrics/signal.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::metrics {

/// Largest value, and the mean over time.
class TimeMean {
  public:
    void add(double value, double seconds) {
        max_ = std::max(max_, value);
        sum_ += value * seconds;
        seconds_ += seconds;
    }
    /// NaN before anything was added.
    [[nodiscard]] double max() const { return max_ >= 0.0 ? max_ : std::numeric_limits<double>::quiet_NaN(); }
    [[nodiscard]] double mean() const {
        return seconds_ > 0.0 ? sum_ / seconds_ : std::numeric_limits<double>::quiet_NaN();
    }
    [[nodiscard]] double integral() const { return sum_; }
    [[nodiscard]] double seconds() const { return seconds_; }

  private:
    double max_ = -1.0;  // all quantities it serves are non-negative
    double sum_ = 0.0;
    double seconds_ = 0.0;
};

/// Net forces [N] on tissues in one snapshot.
struct TissueForces {
    double gum = 0.0, epiglottis = 0.0, tongue = 0.0;
};

[[nodiscard]] TissueForces tissue_forces(const scene::Snapshot& snapshot);

/// What one snapshot means for an attempt; worked out once per snapshot.
struct Moment {
    double time = 0.0;     ///< [s] since the attempt began
    double seconds = 0.0;  ///< since the snapshot before
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
    double oxygen_saturation = std::numeric_limits<double>::quiet_NaN();  ///< [%], where it is simulated
    double heart_rate = std::numeric_limits<double>::quiet_NaN();         ///< [1/min], likewise
};

/// Speed [m/s] of a moving point over intervals of at least `interval` [s]: differences between
/// neighbouring steps would show the solver's noise as speed.
class SpeedMeter {
  public:
    explicit SpeedMeter(double interval) : interval_(interval) {}
    void restart() { started_ = false; }
    /// True when an interval has been completed; `speed` and `seconds` then hold its values.
    bool add(double time, const Vec3f& point);
    double speed = 0.0;
    double seconds = 0.0;

  private:
    double interval_;
    double since_ = 0.0;
    Vec3f from_ = Vec3f::Zero();
    bool started_ = false;
};

/// The parameters of one attempt as they grow.
class Attempt {
  public:
    Attempt(double weight_kg, double time_limit);

    void add(const Moment& moment);

    /// Values so far; rocking and smoothness, which need the whole curve, as of the last refresh.
    [[nodiscard]] const Parameters& parameters() const { return parameters_; }
    /// Works out rocking and smoothness; about 0.5 ms for an attempt of 30 s.
    void refresh_curves();

    [[nodiscard]] RunPart::Weights weights() const;
    [[nodiscard]] bool passed_glottis() const { return passed_glottis_; }
    [[nodiscard]] bool glottis_seen() const { return seen_; }
    [[nodiscard]] bool epiglottis_seen() const { return epiglottis_seen_; }

  private:
    void fill_means();

    double time_limit_;
    Parameters parameters_ = starting_parameters();
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

/// Grade after Cormack & Lehane 1984 (Anaesthesia 39:1105) from the best view: 1 most of the glottis
/// (half or more), 2 part of it, 3 only the epiglottis, 4 neither.
[[nodiscard]] double cormack_lehane_grade(double best_opening_percent, bool epiglottis_seen);

}  // namespace eti::metrics
