// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>

#include "common/model/attempt_metrics_json.hpp"
#include "common/model/run.hpp"

namespace eti::review {

namespace {

nlohmann::ordered_json outcome_json(const Summary& summary, const session::SummaryRecord& record) {
    nlohmann::ordered_json out;
    out["success"] = summary.outcome_known(record) ? nlohmann::ordered_json(record.outcome.success)
                                                   : nlohmann::ordered_json(nullptr);
    out["reason"] = record.outcome.reason;
    out["parameters"] = metrics_to_json(record.metrics);
    return out;
}

/// Position of the tube by the last steps.
std::string last_tube_position(std::span<const session::StepRecord> steps) {
    const auto past = [](const session::StepRecord& step) {
        return step.measures.tube_depth_past_glottis > 0.0f;
    };
    const auto last = std::find_if(steps.rbegin(), steps.rend(), past);
    if (last == steps.rend()) {
        return "the tube had not passed the glottis";
    }
    if (last != steps.rbegin()) {
        return fmt::format("the tube had passed the glottis and left the trachea again at {:.1f} s",
                           seconds_of(*(last - 1)));
    }
    const auto before = std::find_if_not(last, steps.rend(), past);
    return fmt::format("the tube passed the glottis at {:.1f} s and lay {:.0f} mm beyond it",
                       seconds_of(*(before - 1)),
                       1e3 * static_cast<double>(steps.back().measures.tube_depth_past_glottis));
}

/// Reconstructs the summary of an interrupted run from its steps.
void sum_up(Summary& summary, std::span<const session::StepRecord> steps) {
    for (const MetricField& field : metric_fields) {
        summary.run.metrics.*field.value = std::numeric_limits<double>::quiet_NaN();
    }
    const std::string_view ends =
        summary.live ? "the session is still being recorded; so far" : "the recording ends";
    if (steps.empty()) {
        summary.run.outcome.reason = fmt::format("{} before the first step", ends);
        return;
    }
    const session::StepRecord& last = steps.back();
    summary.run.outcome.reason = fmt::format("{} at {:.1f} s, before the results were computed; {}", ends,
                                             seconds_of(last), last_tube_position(steps));
    summary.run.metrics = last.metrics;
    if (!last.attempt_running) {
        return;
    }
    session::SummaryRecord open{last.attempt, {false, summary.run.outcome.reason}, last.metrics};
    summary.unfinished_attempt = last.attempt;
    // Between attempts a step contains the run so far.
    const auto outside = std::find_if(steps.rbegin(), steps.rend(),
                                      [](const session::StepRecord& step) { return !step.attempt_running; });
    if (last.attempt > 1 && outside != steps.rend()) {
        constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
        const RunPart parts[] = {{outside->metrics, {outside->metrics.time_s, unknown, unknown}, false},
                                 {last.metrics, {last.metrics.time_s, unknown, unknown}, false}};
        summary.run.metrics = combine(parts);
        summary.run.metrics.head_elevation_deg = unknown;  // the recording does not say which passage was
                                                           // the last
    }
    summary.attempts.push_back(std::move(open));
}

}  // namespace

Summary summarise(const std::filesystem::path& file) {
    const session::SessionReader reader(file);
    Summary summary;
    summary.file = file;
    summary.info = reader.info();
    summary.duration = reader.duration();
    summary.finished = reader.finished();
    summary.live = reader.is_being_recorded();
    summary.lost_records = reader.lost_records();
    for (session::SummaryRecord& record : reader.summaries()) {
        if (record.attempt == 0) {
            summary.has_run = true;
            summary.run = std::move(record);
        } else {
            summary.attempts.push_back(std::move(record));
        }
    }
    for (session::EventRecord& event : reader.events()) {
        if (event.kind == session::note_event || event.kind == session::annotation_event) {
            summary.remarks.push_back(std::move(event));
        }
    }
    summary.ratings = session::read_ratings(reader.root());
    summary.answers = session::read_answers(reader.root());
    if (!summary.has_run) {
        sum_up(summary, reader.steps());
    }
    return summary;
}

void put_session(nlohmann::ordered_json& into, const Summary& summary) {
    into["session"] = summary.info.session;
    into["start_time"] = summary.info.start_time;
    into["scenario"] = summary.info.scenario;
    into["operator"] = summary.info.operator_name;
    into["version"] = summary.info.version;
    if (const std::string quality = summary.info.text(session::quality_text); !quality.empty()) {
        into["quality"] = quality;
    }
    into["duration_s"] = summary.duration;
    into["finished"] = summary.finished;
    into["lost_records"] = summary.lost_records;
}

nlohmann::ordered_json ratings_json(const std::vector<session::Rating>& ratings) {
    auto out = nlohmann::ordered_json::array();
    for (const session::Rating& rating : ratings) {
        out.push_back({{"rater", rating.rater},
                       {"item", rating.item},
                       {"score", rating.score},
                       {"given", rating.given}});
    }
    return out;
}

nlohmann::ordered_json answers_json(const std::vector<session::Answer>& answers) {
    auto out = nlohmann::ordered_json::array();
    for (const session::Answer& answer : answers) {
        out.push_back({{"form", answer.form},
                       {"question", answer.question},
                       {"text", answer.text},
                       {"answer", answer.answer},
                       {"given", answer.given}});
    }
    return out;
}

std::string_view outcome_word(const Summary& summary, const session::SummaryRecord& record) {
    return !summary.outcome_known(record) ? "unknown" : record.outcome.success ? "success" : "no success";
}

nlohmann::ordered_json to_json(const Summary& summary) {
    nlohmann::ordered_json out = outcome_json(summary, summary.run);
    out["attempts"] = nlohmann::ordered_json::array();
    for (const session::SummaryRecord& attempt : summary.attempts) {
        nlohmann::ordered_json entry;
        entry["attempt"] = attempt.attempt;
        entry.update(outcome_json(summary, attempt));
        out["attempts"].push_back(std::move(entry));
    }
    out["file"] = summary.file.string();
    put_session(out, summary);
    out["remarks"] = nlohmann::ordered_json::array();
    for (const session::EventRecord& remark : summary.remarks) {
        out["remarks"].push_back({{"time_s", 1e-9 * static_cast<double>(remark.time_ns)},
                                  {"kind", remark.kind},
                                  {"text", remark.text}});
    }
    out["ratings"] = ratings_json(summary.ratings);
    out["answers"] = answers_json(summary.answers);
    return out;
}

}  // namespace eti::review
