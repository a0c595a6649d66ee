// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hud/readout.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "client/text/catalogue.hpp"
#include "client/text/server_sentences.hpp"
#include "common/math/units.hpp"

namespace eti::hud {
namespace {

using text::translate;

constexpr double verdict_for_s = 8.0;       // of simulation time
constexpr double description_for_s = 10.0;  // likewise
constexpr double note_for_s = 15.0;         // likewise; enough to read it twice at three words a second

constexpr double last_seconds = 10.0;  // [s], end of an attempt's time
// Deviation of the depth at the lip from the rule; chosen: a tube's marks are 0.5 to 1 cm apart.
constexpr double depth_warning_cm = 0.5, depth_bad_cm = 1.0;

// Values shown at the end of an attempt; eti-review shows all.
constexpr std::array shown{&AttemptMetrics::time_s, &AttemptMetrics::gum_force_max_n,
                           &AttemptMetrics::glottic_opening_max_percent,
                           &AttemptMetrics::tube_depth_at_lip_cm, &AttemptMetrics::tube_depth_rule_cm};

Verdict verdict_of(const bus::AttemptReport& report) {
    Verdict verdict;
    const Outcome& outcome = report.outcome;
    verdict.level = !outcome.known ? Level::neutral : outcome.success ? Level::good : Level::bad;
    verdict.title =
        text::translate_format("{}: {}",
                               report.attempt == 0 ? std::string(translate("session"))
                                                   : text::translate_format("attempt {}", report.attempt),
                               !outcome.known    ? translate("outcome unknown")
                               : outcome.success ? translate("success")
                                                 : translate("no success"));
    verdict.reason = text::translate_sentence(outcome.reason);
    for (double AttemptMetrics::*const one : shown) {
        const auto field = std::ranges::find(metric_fields, one, &MetricField::value);
        const double value = report.metrics.*one;
        verdict.numbers.emplace_back(translate(field->label),
                                     std::isnan(value) ? "-" : fmt::format("{:.1f} {}", value, field->unit));
    }
    return verdict;
}

std::optional<Verdict> verdict_now(const view::SceneView& scene, const Readout& readout) {
    if (readout.link == ServerLink::finished && scene.run_report()) {
        return verdict_of(*scene.run_report());
    }
    const auto& last = scene.attempt_report();
    if (last && (readout.link == ServerLink::finished ||
                 readout.time_s - 1e-9 * static_cast<double>(last->ended_ns) < verdict_for_s)) {
        return verdict_of(*last);
    }
    return std::nullopt;
}

std::string note_now(const view::SceneView& scene) {
    const bus::Annotation* newest = nullptr;
    for (const auto& [slot, annotation] : scene.annotations()) {
        if (annotation.kind == msg::ANNOTATION_NOTE &&
            (newest == nullptr || annotation.time_ns >= newest->time_ns)) {
            newest = &annotation;
        }
    }
    const auto age_ns = [&] {
        return static_cast<double>(scene.simulation_time_ns()) - static_cast<double>(newest->time_ns);
    };
    return newest != nullptr && 1e-9 * age_ns() < note_for_s ? newest->text : std::string();
}

std::string warning_of(const msg::SessionStatus& status) {
    const bool blade = status.laryngoscope() == msg::DEVICE_SILENT,
               tube = status.tube() == msg::DEVICE_SILENT;
    if (!blade && !tube) {
        return {};
    }
    const std::string_view silent = blade && tube ? translate("laryngoscope and tube are silent")
                                    : blade       ? translate("laryngoscope is silent")
                                                  : translate("tube is silent");
    return status.phase() == msg::PHASE_FROZEN ? text::translate_format("{}: simulation paused", silent)
                                               : std::string(silent);
}

// Warnings that a supervisor would call out.
std::vector<std::string> alarms_of(float gum_force_n, msg::TubePlace tube, const AttemptMetrics& now) {
    std::vector<std::string> alarms;
    if (level_of(&LiveMeasures::gum_force_n, gum_force_n) == Level::bad) {
        alarms.emplace_back(translate("pressing on the upper gum"));
    }
    switch (tube) {
        case msg::TUBE_IN_OESOPHAGUS:
            alarms.emplace_back(translate("tube in the oesophagus"));
            break;
        case msg::TUBE_IN_MAIN_STEM:
            alarms.emplace_back(translate("tube in a main bronchus"));
            break;
        case msg::TUBE_IN_TRACHEA:
            if (now.tube_depth_at_lip_cm > now.tube_depth_rule_cm + depth_bad_cm) {
                alarms.emplace_back(translate("tube too deep"));
            }
            break;
        default:
            break;
    }
    return alarms;
}

}  // namespace

Level Readout::Clock::level() const {
    return time_s > limit_s ? Level::bad : time_s > limit_s - last_seconds ? Level::warning : Level::good;
}

Level Readout::TubeDepth::level() const {
    const double off = std::abs(at_lip_cm - rule_cm);
    return off > depth_bad_cm ? Level::bad : off > depth_warning_cm ? Level::warning : Level::good;
}

Level level_of(float LiveMeasures::*measure, double value) {
    const LiveMeasureField& field = live_measure(measure);
    const auto beyond = [&](double limit) {
        return field.bad < field.warning ? value < limit : value > limit;
    };
    return beyond(field.bad) ? Level::bad : beyond(field.warning) ? Level::warning : Level::good;
}

float blade_depth(const Landmarks& points, const Vec3f& tip) {
    const Vec3f& gum = at(points, Landmark::upper_gum);
    const Vec3f past = tip - gum;
    return past.dot(at(points, Landmark::glottis) - gum) > 0.0f ? past.norm() : 0.0f;
}

Readout make_readout(const view::SceneView& scene, bool server_lost, bool contested) {
    Readout readout;
    readout.time_s = 1e-9 * static_cast<double>(scene.simulation_time_ns());
    if (const auto& status = scene.status()) {
        readout.link = status->phase() == msg::PHASE_FINISHED ? ServerLink::finished : ServerLink::running;
        readout.server_load = status->load();
        readout.behind_s = status->behind_s();
        readout.warning = contested ? std::string(translate("two servers run this session: stop one"))
                                    : warning_of(*status);
    }
    if (const auto& description = scene.description()) {
        readout.scenario = description->scenario().to_string();
    }
    if (!scene.complete()) {
        readout.link = ServerLink::waiting;
    }
    if (server_lost && readout.link != ServerLink::finished) {
        readout.link = ServerLink::lost;
    }
    if (const auto& metrics = scene.metrics()) {
        readout.attempt = metrics->attempt();
        readout.attempt_running = metrics->attempt_running();
        readout.measures = scene.measures();
        readout.message = text::translate_sentence(metrics->message().to_string());
    }
    if (scene.metrics() && scene.keys()) {
        const AttemptMetrics now = scene.keys()->metrics(scene.metrics()->parameters());
        readout.airway_measured = airway_measured(now);
        if (scene.shows(&RuntimeParameters::view_clock) && readout.attempt_running &&
            std::isfinite(now.time_s)) {
            readout.clock = {now.time_s, static_cast<double>(scene.description()->time_limit_s())};
        }
        if (scene.shows(&RuntimeParameters::view_tube_depth) && !std::isnan(now.tube_depth_at_lip_cm)) {
            readout.tube_depth = {now.tube_depth_at_lip_cm, now.tube_depth_rule_cm};
        }
        if (scene.shows(&RuntimeParameters::view_warnings) && readout.airway_measured) {
            readout.alarms = alarms_of(readout.measures.gum_force_n, scene.metrics()->tube_place(), now);
        }
        if (!std::isnan(now.oxygen_saturation_end_percent) && !std::isnan(now.heart_rate_end_per_min)) {
            readout.vital_signs = {now.oxygen_saturation_end_percent, now.heart_rate_end_per_min};
        }
    }
    if (scene.keys() && scene.laryngoscope_pose()) {
        const Vec3f tip = *scene.laryngoscope_pose() * scene.keys()->laryngoscope().tip();
        readout.blade_depth_cm = blade_depth(scene.landmarks(), tip) / centimetre;
    }
    if (scene.description() && (readout.link == ServerLink::waiting || readout.time_s < description_for_s)) {
        readout.description = translate(scene.description()->description().to_string());
    }
    if (readout.link == ServerLink::finished && !scene.scenario().debriefing.empty()) {
        readout.description = scene.scenario().debriefing;
    }
    readout.note = note_now(scene);
    readout.verdict = verdict_now(scene, readout);
    return readout;
}

}  // namespace eti::hud
