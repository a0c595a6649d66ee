// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/summary.hpp"

#include <limits>

#include "common/model/parameters_json.hpp"

namespace eti::review {

namespace {

nlohmann::ordered_json outcome_json(const session::SummaryRecord& record) {
    nlohmann::ordered_json out;
    out["success"] = record.outcome.success;
    out["reason"] = record.outcome.reason;
    out["parameters"] = parameters_to_json(record.parameters);
    return out;
}

}  // namespace

Summary summarise(const std::filesystem::path& file) {
    const session::SessionReader reader(file);
    Summary summary;
    summary.file = file;
    summary.info = reader.info();
    summary.duration = reader.duration();
    summary.finished = reader.finished();
    summary.live = reader.live();
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
    if (!summary.has_run) {
        summary.run.outcome = {false, summary.live ? "the session is still being recorded"
                                                   : "the recording ended before the run was summed up"};
        for (const ParameterField& field : parameter_fields) {
            summary.run.parameters.*field.value = std::numeric_limits<double>::quiet_NaN();
        }
    }
    return summary;
}

nlohmann::ordered_json to_json(const Summary& summary) {
    nlohmann::ordered_json out = outcome_json(summary.run);
    out["attempts"] = nlohmann::ordered_json::array();
    for (const session::SummaryRecord& attempt : summary.attempts) {
        nlohmann::ordered_json entry;
        entry["attempt"] = attempt.attempt;
        entry.update(outcome_json(attempt));
        out["attempts"].push_back(std::move(entry));
    }
    out["file"] = summary.file.string();
    out["session"] = summary.info.session;
    out["start_time"] = summary.info.start_time;
    out["scenario"] = summary.info.scenario;
    out["operator"] = summary.info.operator_name;
    out["version"] = summary.info.version;
    out["duration_s"] = summary.duration;
    out["finished"] = summary.finished;
    out["lost_records"] = summary.lost_records;
    out["remarks"] = nlohmann::ordered_json::array();
    for (const session::EventRecord& remark : summary.remarks) {
        out["remarks"].push_back({{"time_s", 1e-9 * static_cast<double>(remark.time_ns)},
                                  {"kind", remark.kind},
                                  {"text", remark.text}});
    }
    return out;
}

}  // namespace eti::review
