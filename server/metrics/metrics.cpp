// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/metrics/metrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/model/thresholds.hpp"

namespace eti::metrics {
namespace {

constexpr double nanoseconds = 1e-9;  // [s]

// Rocking and smoothness need the whole curve of an attempt.
constexpr double refresh_interval = 1.0;  // [s]

// Beyond this a run repeats itself; later events are dropped, as the last entry says.
constexpr std::size_t max_events = 1000;

// Thresholds of severe events during intubation: Herrick et al. 2020 (Neonatology 117:65) and the neonatal
// airway registry use a fall by 20 points and a heart rate below 100.
constexpr double low_saturation = 80.0;   // [%]
constexpr double low_heart_rate = 100.0;  // [1/min]

double unknown() {
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

void Metrics::begin(const patient::Patient& patient, const Laryngoscope& scope, double time_limit,
                    const std::optional<physiology::Physiology>& physiology, PatientKind of) {
    *this = Metrics{};
    of_ = of;
    scope_ = scope;
    weight_ = static_cast<double>(patient.weight);
    time_limit_ = time_limit;
    depth_at_lip_ = unknown();
    if (physiology) {
        vital_signs_.emplace(*physiology);
    }
}

void Metrics::log_event(std::string text) {
    live_.message = text;
    if (events_.size() + 1 < max_events) {
        events_.push_back({last_ns_.value_or(0), std::move(text)});
    } else if (events_.size() + 1 == max_events) {
        events_.push_back({last_ns_.value_or(0), "further events are not listed"});
    }
}

void Metrics::observe(const scene::Snapshot& snapshot, const GlotticView& view) {
    if (last_ns_ && snapshot.time_ns <= *last_ns_) {
        return;
    }
    const double seconds = last_ns_ ? static_cast<double>(snapshot.time_ns - *last_ns_) * nanoseconds : 0.0;
    first_ns_ = first_ns_.value_or(snapshot.time_ns);
    last_ns_ = snapshot.time_ns;
    now_ = static_cast<double>(snapshot.time_ns - *first_ns_) * nanoseconds;

    const AirwayGates places = airway_gates(snapshot);
    trachea_length_ = places.trachea_length();
    const Vec3f blade_tip = snapshot.proxy * scope_.tip();
    const GateTracker::Change blade =
        blade_.update(places.mouth.past(blade_tip),
                      places.mouth.radial_distance(blade_tip) < threshold::mouth_radius.as_float(), true,
                      threshold::gate_slack.as_float());
    AirwayWatch::Changes changes;
    depth_at_lip_ = unknown();
    if (!snapshot.tube_nodes.empty()) {
        live_.tube_tip = snapshot.tube_nodes.back();
        changes = tube_.update(live_.tube_tip, places);
        if (const auto depth = depth_at_lip(snapshot.tube_nodes, places.mouth); depth && tube_.in_mouth()) {
            depth_at_lip_ = static_cast<double>(*depth);
        }
        live_.measures.tube_depth_past_glottis = tube_.past_glottis();
        live_.tube_place = tube_.place();
    }
    const TissueForces forces = tissue_forces(snapshot);
    live_.measures.gum_force_n = static_cast<float>(forces.gum);
    live_.measures.glottic_opening_percent = view.opening_percent;
    live_.measures.tube_force_n = snapshot.tube_force.norm();
    live_.measures.tongue_force_n = static_cast<float>(forces.tongue);
    live_.measures.epiglottis_in_sight = view.epiglottis_seen ? 1.0f : 0.0f;

    const bool starts = blade == GateTracker::Change::in;
    if (starts) {
        start_attempt();
    }
    log_vital_signs(seconds);
    const double opening = static_cast<double>(view.opening_percent);
    run_tracker_.add(tube_, changes, attempt_ ? opening : 0.0, now_);
    if (attempt_) {
        attempt_tracker_.add(tube_, changes, opening, now_);
        AttemptSample sample;
        sample.time = now_ - attempt_began_;
        sample.seconds = starts ? 0.0 : seconds;
        sample.forces = forces;
        sample.blade_tip = blade_tip;
        sample.blade_depth = (blade_tip - at(snapshot.landmarks, Landmark::upper_gum)).norm();
        sample.angles = blade_angles(snapshot);
        sample.view = view;
        sample.tube_in_mouth = tube_.in_mouth();
        sample.tube_tip = live_.tube_tip;
        sample.tube_grip = snapshot.tube_grip.translation;
        sample.tube = changes;
        sample.tube_at_glottis = tube_.in_mouth() && (live_.tube_tip - places.glottis.centre).norm() <
                                                         threshold::glottis_radius.as_float();
        sample.head_elevation = snapshot.runtime_parameters.head_elevation;
        sample.depth_at_lip = depth_at_lip_;
        if (vital_signs_) {
            sample.oxygen_saturation = vital_signs_->oxygen_saturation();
            sample.heart_rate = vital_signs_->heart_rate();
        }
        add_to_attempt(sample);
    } else {
        entries_between_ += changes.oesophagus == GateTracker::Change::in ? 1 : 0;
        main_stem_between_ += changes.main_stem == GateTracker::Change::in ? 1 : 0;
    }
    if (of_ == PatientKind::newborn) {
        log_transitions(changes);
    }
    if (blade == GateTracker::Change::out && attempt_) {
        end_attempt();
    }
}

void Metrics::add_to_attempt(const AttemptSample& sample) {
    const bool in_time = attempt_->metrics().over_time_limit == 0;
    attempt_->add(sample);
    if (in_time && attempt_->metrics().over_time_limit > 0) {
        log_event(fmt::format("attempt {} takes longer than {:.0f} s", live_.attempt, time_limit_));
    }
    if (attempt_->glottis_seen() && !seen_in_attempt_) {
        seen_in_attempt_ = true;
        log_event("the glottis came into view");
    }
    if (sample.time >= next_refresh_) {
        attempt_->refresh_curves();
        next_refresh_ += refresh_interval;
    }
}

void Metrics::log_transitions(const AirwayWatch::Changes& changes) {
    using enum GateTracker::Change;
    if (changes.trachea != none) {
        log_event(changes.trachea == in ? "the tube passed the glottis" : "the tube left the trachea");
    }
    if (changes.oesophagus != none) {
        log_event(changes.oesophagus == in ? "the tube went into the oesophagus"
                                           : "the tube left the oesophagus");
    }
    if (changes.main_stem != none) {
        log_event(changes.main_stem == in ? "the tube passed the carina"
                                          : "the tube came back above the carina");
    }
}

// The blade in the mouth keeps the mask off. Between attempts the newborn is ventilated: through the tube if
// it is in the airway, else through the mask. A tube in the oesophagus does not ventilate the lungs.
physiology::Ventilation Metrics::ventilation() const {
    if (attempt_ || tube_.in_oesophagus()) {
        return physiology::Ventilation::none;
    }
    return tube_.in_main_stem() ? physiology::Ventilation::one_lung : physiology::Ventilation::both_lungs;
}

void Metrics::log_vital_signs(double seconds) {
    if (!vital_signs_) {
        return;
    }
    vital_signs_->advance(seconds, ventilation());
    live_.measures.oxygen_saturation_percent = static_cast<float>(vital_signs_->oxygen_saturation());
    live_.measures.heart_rate_per_min = static_cast<float>(vital_signs_->heart_rate());
    const auto watch = [&](bool& low, double value, double limit, double back, const char* fell,
                           const char* recovered) {
        if (!low && value < limit) {
            low = true;
            log_event(fell);
        } else if (low && value > back) {
            low = false;
            log_event(recovered);
        }
    };
    watch(desaturated_, vital_signs_->oxygen_saturation(), low_saturation, low_saturation + 2.0,
          "the oxygen saturation fell below 80 %", "the oxygen saturation is above 80 % again");
    watch(bradycardic_, vital_signs_->heart_rate(), low_heart_rate, low_heart_rate + 5.0,
          "the heart rate fell below 100 a minute", "the heart rate is above 100 a minute again");
}

void Metrics::start_attempt() {
    attempt_.emplace(weight_, time_limit_);
    attempt_began_ = now_;
    next_refresh_ = refresh_interval;
    seen_in_attempt_ = false;
    attempt_tracker_ = {};
    attempt_tracker_.blade_entered = true;
    run_tracker_.blade_entered = true;
    live_.attempt = static_cast<std::uint32_t>(attempts_.size() + 1);
    live_.attempt_running = true;
    log_event(fmt::format("attempt {} began", live_.attempt));
}

void Metrics::end_attempt() {
    const AttemptMetrics& so_far = attempt_->metrics();
    if (so_far.time_s < threshold::least_attempt.value) {
        log_event(fmt::format("attempt {} does not count: the blade was in the mouth for {:.2f} s",
                              live_.attempt, so_far.time_s));
        entries_between_ += static_cast<int>(so_far.oesophageal_entries);
        main_stem_between_ += static_cast<int>(so_far.main_stem_entries);
        attempt_.reset();
        live_.attempt = static_cast<std::uint32_t>(attempts_.size());
        live_.attempt_running = false;
        return;
    }
    attempt_->refresh_curves();
    attempt_tracker_.duration = attempt_->metrics().time_s;
    AttemptSummary summary{live_.attempt, attempt_began_, now_, outcome(attempt_tracker_),
                           measured(attempt_->metrics())};
    log_event(fmt::format("attempt {} ended: {}", summary.number, summary.outcome.reason));
    attempts_.push_back(std::move(summary));
    weights_.push_back(attempt_->weights());
    passed_.push_back(attempt_->passed_glottis());
    attempt_.reset();
    live_.attempt_running = false;
}

void Metrics::finish() {
    if (attempt_) {
        end_attempt();
    }
}

AttemptMetrics Metrics::current_metrics() const {
    return attempt_ ? measured(attempt_->metrics()) : run().metrics;
}

AttemptMetrics Metrics::measured(AttemptMetrics metrics) const {
    for (const MetricField& field : metric_fields) {
        if (of_ == PatientKind::manikin && !depends_only_on_tool_poses(field)) {
            metrics.*field.value = unknown();
        }
    }
    return metrics;
}

Outcome Metrics::outcome(const OutcomeTracker& tracker) const {
    if (of_ == PatientKind::manikin) {
        return {false, "on a manikin intubation of the trachea is not measured; an observer has to judge it",
                false};
    }
    return evaluate_outcome(tracker, tube_, trachea_length_, time_limit_);
}

AttemptSummary Metrics::run() const {
    std::vector<RunPart> parts;
    for (std::size_t i = 0; i < attempts_.size(); ++i) {
        parts.push_back({attempts_[i].metrics, weights_[i], passed_[i]});
    }
    if (attempt_) {
        parts.push_back({attempt_->metrics(), attempt_->weights(), attempt_->passed_glottis()});
    }
    AttemptSummary summary;
    summary.ended = now_;
    summary.metrics = combine(parts);
    summary.metrics.tube_depth_rule_cm = 100.0 * tube_depth_by_weight(weight_);
    summary.metrics.tube_depth_at_lip_cm = 100.0 * depth_at_lip_;
    if (vital_signs_) {
        summary.metrics.oxygen_saturation_end_percent = vital_signs_->oxygen_saturation();
        summary.metrics.heart_rate_end_per_min = vital_signs_->heart_rate();
    }
    summary.metrics.oesophageal_entries += entries_between_;
    summary.metrics.main_stem_entries += main_stem_between_;
    OutcomeTracker tracker = run_tracker_;
    for (const RunPart& part : parts) {
        tracker.duration = std::max(tracker.duration, part.metrics.time_s);
    }
    summary.metrics = measured(summary.metrics);
    summary.outcome = outcome(tracker);
    return summary;
}

}  // namespace eti::metrics
