// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <span>

#include "client/review/summary.hpp"

namespace eti::review {

namespace {

/// Number of attempts that fits a table into 100 columns; more go into further tables.
constexpr std::size_t attempts_per_block = 3;
constexpr int value_width = 11;

/// Counts and grades without decimals.
std::string value_text(double value) {
    if (!std::isfinite(value)) {
        return "-";
    }
    return value == std::round(value) && std::abs(value) < 1e6 ? fmt::format("{:.0f}", value)
                                                               : fmt::format("{:.2f}", value);
}

std::string column_title(const session::SummaryRecord& record) {
    return record.attempt == 0 ? "run" : fmt::format("attempt {}", record.attempt);
}

void add_rows(std::string& out, std::span<const session::SummaryRecord* const> columns,
              std::size_t label_width, bool in_paper) {
    for (const MetricField& field : metric_fields) {
        if (field.in_paper != in_paper) {
            continue;
        }
        out += fmt::format("  {:<{}}  {:<5}", field.label, label_width, field.unit);
        for (const session::SummaryRecord* record : columns) {
            out += fmt::format("{:>{}}", value_text(record->metrics.*field.value), value_width);
        }
        out += '\n';
    }
}

std::string one_table(std::span<const session::SummaryRecord* const> columns) {
    std::size_t label_width = 0;
    for (const MetricField& field : metric_fields) {
        label_width = std::max(label_width, field.label.size());
    }
    std::string titles = std::string(label_width + 2 + 5, ' ');
    for (const session::SummaryRecord* record : columns) {
        titles += fmt::format("{:>{}}", column_title(*record), value_width);
    }
    std::string out = "  " + titles + "\n";
    add_rows(out, columns, label_width, true);
    out += "  Beyond the paper\n";
    add_rows(out, columns, label_width, false);
    return out;
}

}  // namespace

std::string to_table(const Summary& summary) {
    std::string out = fmt::format("Session       {}\n", summary.info.session);
    out += fmt::format("Scenario      {}{}\n", summary.info.scenario,
                       summary.info.operator_name.empty() ? "" : ", operator " + summary.info.operator_name);
    out += fmt::format("Recorded      {}, {:.1f} s{}\n", summary.info.start_time, summary.duration,
                       summary.live       ? ", still being recorded"
                       : summary.finished ? ""
                                          : ", cut off before its end");
    if (summary.lost_records > 0) {
        out += fmt::format("Lost          {} records, because the disk was too slow\n", summary.lost_records);
    }
    out +=
        fmt::format("Outcome       {}: {}\n", outcome_word(summary, summary.run), summary.run.outcome.reason);
    for (const session::SummaryRecord& attempt : summary.attempts) {
        out += fmt::format("Attempt {:<5} {}: {}\n", attempt.attempt, outcome_word(summary, attempt),
                           attempt.outcome.reason);
    }
    std::size_t first = 0;
    do {
        std::vector<const session::SummaryRecord*> columns;
        if (first == 0) {
            columns.push_back(&summary.run);
        }
        for (; first < summary.attempts.size() && columns.size() < attempts_per_block + 1; ++first) {
            columns.push_back(&summary.attempts[first]);
        }
        out += '\n' + one_table(columns);
    } while (first < summary.attempts.size());
    for (const session::EventRecord& remark : summary.remarks) {
        out += fmt::format("{}{:10.1f} s  {}\n", &remark == &summary.remarks.front() ? "\nRemarks\n" : "",
                           1e-9 * static_cast<double>(remark.time_ns), remark.text);
    }
    for (const session::Rating& rating : summary.ratings) {
        out += fmt::format("{}  {} of {}: {}\n",
                           &rating == &summary.ratings.front() ? "\nRatings, 1 to 5\n" : "", rating.item,
                           rating.rater, rating.score);
    }
    for (const session::Answer& answer : summary.answers) {
        out += fmt::format("{}  {}: {}\n", &answer == &summary.answers.front() ? "\nAnswers\n" : "",
                           answer.text, answer.answer);
    }
    return out;
}

}  // namespace eti::review
