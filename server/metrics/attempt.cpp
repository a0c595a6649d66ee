// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/metrics/attempt.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/math/units.hpp"
#include "common/model/thresholds.hpp"
#include "common/model/tools/tools.hpp"

namespace eti::metrics {
namespace {

// Nine minutes at 30 Hz, after which adjacent bins merge and bin width doubles.
constexpr std::size_t curve_capacity = std::size_t{1} << 14;

double in_degrees(double radians) {
    return radians / static_cast<double>(degree);
}

}  // namespace

TissueForces tissue_forces(const scene::Snapshot& snapshot) {
    TissueForces forces;
    for (const rigid::Contact& contact : snapshot.shell_contacts) {
        const double force = static_cast<double>(contact.force);
        forces.gum += contact.tissue == Tissue::upper_gum ? force : 0.0;
        forces.epiglottis += contact.tissue == Tissue::epiglottis ? force : 0.0;
        forces.tongue += contact.tissue == Tissue::tongue ? force : 0.0;
    }
    Vec3f gum = Vec3f::Zero();
    Vec3f epiglottis = Vec3f::Zero();
    Vec3f tongue = Vec3f::Zero();
    for (const scene::TissueContact& contact : snapshot.tissue_contacts) {
        if (contact.tissue == Tissue::upper_gum) {
            gum += contact.force;
        } else if (contact.tissue == Tissue::epiglottis) {
            epiglottis += contact.force;
        } else if (contact.tissue == Tissue::tongue) {
            tongue += contact.force;
        }
    }
    forces.gum += static_cast<double>(gum.norm());
    forces.epiglottis += static_cast<double>(epiglottis.norm());
    forces.tongue += static_cast<double>(tongue.norm());
    return forces;
}

bool SpeedMeter::add(double time, const Vec3f& point) {
    if (!started_) {
        started_ = true;
        since_ = time;
        from_ = point;
        return false;
    }
    // Tolerance of half a microsecond for times that are not whole multiples of the interval.
    if (time - since_ < interval_ - 5e-7) {
        return false;
    }
    seconds = time - since_;
    speed = static_cast<double>((point - from_).norm()) / seconds;
    since_ = time;
    from_ = point;
    return true;
}

double cormack_lehane_grade(double best_opening_percent, bool epiglottis_seen) {
    if (best_opening_percent >= threshold::most_of_the_glottis.value) {
        return 1.0;
    }
    if (best_opening_percent > 0.0) {
        return 2.0;
    }
    return epiglottis_seen ? 3.0 : 4.0;
}

Attempt::Attempt(double weight_kg, double time_limit)
    : time_limit_(time_limit),
      pitch_peaks_(threshold::peak_prominence.value),
      left_peaks_(threshold::peak_prominence.value),
      right_peaks_(threshold::peak_prominence.value),
      pitch_(threshold::curve_rate.value, curve_capacity),
      yaw_(threshold::curve_rate.value, curve_capacity),
      blade_speed_(threshold::speed_rate.value, curve_capacity),
      tube_meter_(1.0 / threshold::speed_rate.value),
      grip_meter_(1.0 / threshold::speed_rate.value),
      blade_meter_(1.0 / threshold::speed_rate.value) {
    metrics_.attempts = 1;
    metrics_.tube_depth_rule_cm = 100.0 * tube_depth_by_weight(weight_kg);
}

void Attempt::add(const AttemptSample& sample) {
    gum_.add(sample.forces.gum, sample.seconds);
    epiglottis_.add(sample.forces.epiglottis, sample.seconds);
    tongue_.add(sample.forces.tongue, sample.seconds);
    depth_.add(static_cast<double>(sample.blade_depth), sample.seconds);

    // Unwrapped: the angle would jump at half a turn.
    pitch_angle_ = sample.time == 0.0 ? sample.angles.pitch
                                      : pitch_angle_ + std::remainder(sample.angles.pitch - pitch_angle_,
                                                                      2.0 * std::numbers::pi);
    const double pitch = in_degrees(pitch_angle_);
    const double yaw = in_degrees(sample.angles.yaw);
    pitch_peaks_.add(pitch);
    left_peaks_.add(yaw);
    right_peaks_.add(-yaw);
    pitch_.add(sample.time, pitch);
    yaw_.add(sample.time, yaw);
    if (blade_meter_.add(sample.time, sample.blade_tip)) {
        // At the middle of the completed interval.
        blade_speed_.add(sample.time - 0.5 * blade_meter_.seconds, blade_meter_.speed);
        metrics_.blade_path_length_cm += 100.0 * blade_meter_.speed * blade_meter_.seconds;
    }

    // The head's elevation is taken at the passage of the glottis; until then, at the best view.
    const double opening = static_cast<double>(sample.view.opening_percent);
    const bool best = opening > best_view_ || sample.time == 0.0;
    if (sample.tube.trachea == GateTracker::Change::in || (best && !passed_glottis_)) {
        metrics_.head_elevation_deg = in_degrees(static_cast<double>(sample.head_elevation));
    }
    best_view_ = std::max(best_view_, opening);
    epiglottis_seen_ = epiglottis_seen_ || sample.view.epiglottis_seen;
    passed_glottis_ = passed_glottis_ || sample.tube.trachea == GateTracker::Change::in;
    tube_reached_glottis_ = tube_reached_glottis_ || sample.tube_at_glottis || passed_glottis_;
    if (seen_ && !tube_reached_glottis_) {
        view_.add(opening, sample.seconds);
        metrics_.view_held_s += opening >= threshold::most_of_the_glottis.value ? sample.seconds : 0.0;
    }
    if (!seen_ && opening > 0.0) {
        seen_ = true;
        metrics_.time_to_first_view_s = sample.time;
    }

    if (sample.tube_in_mouth) {
        if (tube_meter_.add(sample.time, sample.tube_tip)) {
            tube_speed_.add(tube_meter_.speed, tube_meter_.seconds);
        }
        if (grip_meter_.add(sample.time, sample.tube_grip)) {
            grip_speed_.add(grip_meter_.speed, grip_meter_.seconds);
        }
    } else {
        tube_meter_.restart();
        grip_meter_.restart();
    }
    metrics_.oesophageal_entries += sample.tube.oesophagus == GateTracker::Change::in ? 1 : 0;
    metrics_.main_stem_entries += sample.tube.main_stem == GateTracker::Change::in ? 1 : 0;
    metrics_.tube_depth_at_lip_cm = 100.0 * sample.depth_at_lip;
    metrics_.oxygen_saturation_end_percent = sample.oxygen_saturation;
    metrics_.oxygen_saturation_min_percent =
        std::fmin(metrics_.oxygen_saturation_min_percent, sample.oxygen_saturation);
    metrics_.heart_rate_end_per_min = sample.heart_rate;
    metrics_.heart_rate_min_per_min = std::fmin(metrics_.heart_rate_min_per_min, sample.heart_rate);
    metrics_.time_s = sample.time;
    metrics_.over_time_limit = sample.time > time_limit_ ? 1 : 0;
    fill_means();
}

void Attempt::fill_means() {
    AttemptMetrics& p = metrics_;
    const auto or_zero = [](double value) { return std::isnan(value) ? 0.0 : value; };
    p.gum_force_max_n = or_zero(gum_.max());
    p.gum_force_mean_n = or_zero(gum_.mean());
    p.epiglottis_force_max_n = or_zero(epiglottis_.max());
    p.tongue_force_max_n = or_zero(tongue_.max());
    p.blade_depth_max_cm = 100.0 * depth_.max();
    p.blade_depth_mean_cm = 100.0 * (depth_.seconds() > 0.0 ? depth_.mean() : depth_.max());
    p.glottic_opening_max_percent = best_view_;
    p.glottic_opening_mean_percent = or_zero(view_.mean());
    p.tube_speed_max_cm_per_s = 100.0 * tube_speed_.max();
    p.tube_speed_mean_cm_per_s = 100.0 * tube_speed_.mean();
    p.tube_grip_speed_max_cm_per_s = 100.0 * grip_speed_.max();
    p.tube_grip_speed_mean_cm_per_s = 100.0 * grip_speed_.mean();
    p.gum_impulse_n_s = gum_.integral();
    p.epiglottis_impulse_n_s = epiglottis_.integral();
    p.tongue_impulse_n_s = tongue_.integral();
    p.pitch_peaks = pitch_peaks_.count();
    p.yaw_peaks = std::max(left_peaks_.count(), right_peaks_.count());
    p.cormack_lehane_grade = cormack_lehane_grade(best_view_, epiglottis_seen_);
}

void Attempt::refresh_curves() {
    metrics_.pitch_rocking_deg = rocking(pitch_.values());
    metrics_.yaw_rocking_deg = rocking(yaw_.values());
    metrics_.blade_smoothness = log_dimensionless_jerk(blade_speed_.values(), 1.0 / blade_speed_.width());
}

RunPart::Weights Attempt::weights() const {
    return {metrics_.time_s, view_.seconds(), tube_speed_.seconds()};
}

}  // namespace eti::metrics
