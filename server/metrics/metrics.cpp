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

// Rocking and smoothness need an attempt's whole curve.
constexpr double refresh_interval = 1.0;  // [s]

// Beyond it a run repeats itself; later events are dropped and the last entry says so.
constexpr std::size_t most_events = 1000;

// What counts as severe during an intubation: Herrick et al. 2020 (Neonatology 117:65) and the neonatal
// airway registry take a fall by 20 points and a heart rate below 100.
constexpr double low_saturation = 80.0;   // [%]
constexpr double low_heart_rate = 100.0;  // [1/min]

double unknown() {
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

void Metrics::begin(const anatomy::Patient& patient, const Laryngoscope& scope, double time_limit,
                    const std::optional<Physiology>& physiology, Patient of) {
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

void Metrics::note(std::string text) {
    live_.message = text;
    if (events_.size() + 1 < most_events) {
        events_.push_back({last_ns_.value_or(0), std::move(text)});
    } else if (events_.size() + 1 == most_events) {
        events_.push_back({last_ns_.value_or(0), "later events are not listed"});
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

    const Places places = places_in(snapshot);
    trachea_length_ = places.trachea_length();
    const Vec3f blade_tip = snapshot.proxy * scope_.tip();
    const Passage::Change blade = blade_.update(
        places.mouth.past(blade_tip), places.mouth.aside(blade_tip) < threshold::mouth_radius.as_float(),
        true, threshold::gate_slack.as_float());
    AirwayWatch::Changes changes;
    depth_at_lip_ = unknown();
    if (!snapshot.tube_nodes.empty()) {
        live_.tube_tip = snapshot.tube_nodes.back();
        changes = tube_.update(live_.tube_tip, places);
        if (const auto depth = depth_at_lip(snapshot.tube_nodes, places.mouth); depth && tube_.in_mouth()) {
            depth_at_lip_ = static_cast<double>(*depth);
        }
        live_.tube_depth_past_glottis = tube_.past_glottis();
        live_.tube_place = tube_.place();
    }
    const TissueForces forces = tissue_forces(snapshot);
    live_.glottic_opening_percent = view.opening_percent;
    live_.gum_force = static_cast<float>(forces.gum);
    live_.epiglottis_in_sight = view.epiglottis_seen;

    const bool starts = blade == Passage::Change::in;
    if (starts) {
        start_attempt();
    }
    note_vital_signs(seconds);
    const double opening = static_cast<double>(view.opening_percent);
    run_story_.add(tube_, changes, attempt_ ? opening : 0.0, now_);
    if (attempt_) {
        attempt_story_.add(tube_, changes, opening, now_);
        Moment moment;
        moment.time = now_ - attempt_began_;
        moment.seconds = starts ? 0.0 : seconds;
        moment.forces = forces;
        moment.blade_tip = blade_tip;
        moment.blade_depth = (blade_tip - at(snapshot.landmarks, Landmark::upper_gum)).norm();
        moment.angles = blade_angles(snapshot);
        moment.view = view;
        moment.tube_in_mouth = tube_.in_mouth();
        moment.tube_tip = live_.tube_tip;
        moment.tube_grip = snapshot.tube_grip.translation;
        moment.tube = changes;
        moment.tube_at_glottis = tube_.in_mouth() && (live_.tube_tip - places.glottis.centre).norm() <
                                                         threshold::glottis_radius.as_float();
        moment.head_elevation = snapshot.live.head_elevation;
        moment.depth_at_lip = depth_at_lip_;
        moment.oxygen_saturation = live_.oxygen_saturation;
        moment.heart_rate = live_.heart_rate;
        add_to_attempt(moment);
    } else {
        entries_between_ += changes.oesophagus == Passage::Change::in ? 1 : 0;
        main_stem_between_ += changes.main_stem == Passage::Change::in ? 1 : 0;
    }
    if (of_ == Patient::newborn) {
        note_changes(changes);
    }
    if (blade == Passage::Change::out && attempt_) {
        end_attempt();
    }
}

void Metrics::add_to_attempt(const Moment& moment) {
    attempt_->add(moment);
    if (attempt_->glottis_seen() && !seen_in_attempt_) {
        seen_in_attempt_ = true;
        note("the glottis came into sight");
    }
    if (moment.time >= next_refresh_) {
        attempt_->refresh_curves();
        next_refresh_ += refresh_interval;
    }
}

void Metrics::note_changes(const AirwayWatch::Changes& changes) {
    using enum Passage::Change;
    if (changes.trachea != none) {
        note(changes.trachea == in ? "the tube passed the glottis" : "the tube left the trachea");
    }
    if (changes.oesophagus != none) {
        note(changes.oesophagus == in ? "the tube went into the oesophagus" : "the tube left the oesophagus");
    }
    if (changes.main_stem != none) {
        note(changes.main_stem == in ? "the tube passed the carina" : "the tube came back above the carina");
    }
}

// The blade in the mouth keeps the mask off. Between attempts somebody ventilates, through the tube where it
// lies in the airway, else through the mask; what a tube in the oesophagus carries does not reach the lungs.
Ventilation Metrics::ventilation() const {
    if (attempt_ || tube_.in_oesophagus()) {
        return Ventilation::none;
    }
    return tube_.in_main_stem() ? Ventilation::one_lung : Ventilation::both_lungs;
}

void Metrics::note_vital_signs(double seconds) {
    if (!vital_signs_) {
        return;
    }
    vital_signs_->advance(seconds, ventilation());
    live_.oxygen_saturation = vital_signs_->oxygen_saturation();
    live_.heart_rate = vital_signs_->heart_rate();
    const auto watch = [&](bool& low, double value, double limit, double back, const char* fell,
                           const char* recovered) {
        if (!low && value < limit) {
            low = true;
            note(fell);
        } else if (low && value > back) {
            low = false;
            note(recovered);
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
    attempt_story_ = {};
    attempt_story_.blade_entered = true;
    run_story_.blade_entered = true;
    live_.attempt = static_cast<std::uint32_t>(attempts_.size() + 1);
    live_.attempt_running = true;
    note(fmt::format("attempt {} began", live_.attempt));
}

void Metrics::end_attempt() {
    const Parameters& so_far = attempt_->parameters();
    if (so_far.time_s < threshold::least_attempt.value) {
        note(fmt::format("attempt {} does not count: the blade was in the mouth for {:.2f} s", live_.attempt,
                         so_far.time_s));
        entries_between_ += static_cast<int>(so_far.oesophageal_entries);
        main_stem_between_ += static_cast<int>(so_far.main_stem_entries);
        attempt_.reset();
        live_.attempt = static_cast<std::uint32_t>(attempts_.size());
        live_.attempt_running = false;
        return;
    }
    attempt_->refresh_curves();
    attempt_story_.duration = attempt_->parameters().time_s;
    AttemptSummary summary{live_.attempt, attempt_began_, now_, outcome(attempt_story_),
                           measured(attempt_->parameters())};
    note(fmt::format("attempt {} ended: {}", summary.number, summary.outcome.reason));
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

Parameters Metrics::live_parameters() const {
    return attempt_ ? measured(attempt_->parameters()) : run().parameters;
}

Parameters Metrics::measured(Parameters parameters) const {
    for (const ParameterField& field : parameter_fields) {
        if (of_ == Patient::manikin && !follows_from_tools(field)) {
            parameters.*field.value = unknown();
        }
    }
    return parameters;
}

Outcome Metrics::outcome(const Story& story) const {
    if (of_ == Patient::manikin) {
        return {false,
                "on a manikin nothing measures whether the trachea was intubated; whoever looks can tell",
                false};
    }
    return judge(story, tube_, trachea_length_, time_limit_);
}

AttemptSummary Metrics::run() const {
    std::vector<RunPart> parts;
    for (std::size_t i = 0; i < attempts_.size(); ++i) {
        parts.push_back({attempts_[i].parameters, weights_[i], passed_[i]});
    }
    if (attempt_) {
        parts.push_back({attempt_->parameters(), attempt_->weights(), attempt_->passed_glottis()});
    }
    AttemptSummary summary;
    summary.ended = now_;
    summary.parameters = combine(parts);
    summary.parameters.tube_depth_rule_cm = 100.0 * tube_depth_by_weight(weight_);
    summary.parameters.tube_depth_at_lip_cm = 100.0 * depth_at_lip_;
    if (vital_signs_) {
        summary.parameters.oxygen_saturation_end_percent = vital_signs_->oxygen_saturation();
        summary.parameters.heart_rate_end_per_min = vital_signs_->heart_rate();
    }
    summary.parameters.oesophageal_entries += entries_between_;
    summary.parameters.main_stem_entries += main_stem_between_;
    Story story = run_story_;
    for (const RunPart& part : parts) {
        story.duration = std::max(story.duration, part.parameters.time_s);
    }
    summary.parameters = measured(summary.parameters);
    summary.outcome = outcome(story);
    return summary;
}

}  // namespace eti::metrics
