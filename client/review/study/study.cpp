// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/study/study.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "client/review/output.hpp"
#include "common/operator/operator.hpp"
#include "common/scenario/yaml_map.hpp"

namespace eti::review {

namespace {

constexpr int most_participants = 500;
constexpr std::array<std::string_view, 2> orders{"latin_square", "as_listed"};
constexpr std::array<std::string_view, 2> directions{"more", "less"};
constexpr std::array<std::string_view, 4> verdict_words{"agrees", "disagrees", "undecided", "not measured"};

/// A name that is also a valid folder name.
bool is_word(const std::string& text) {
    return !text.empty() && text.front() != '.' && std::ranges::all_of(text, [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
    });
}

void read_conditions(YamlMap& root, Study& study, const std::filesystem::path& folder) {
    for (YamlMap& entry : root.list("conditions")) {
        std::string scenario = entry.name("scenario", "");
        if (scenario.empty()) {
            entry.refuse("scenario", "nothing", "a scenario by name or path");
        }
        const std::string name = entry.name("name", scenario);
        std::error_code ignored;
        if (std::filesystem::is_regular_file(folder / scenario, ignored)) {
            scenario = (folder / scenario).string();  // next to the study file, independent of the working
                                                      // directory
        }
        if (!is_word(name) ||
            std::ranges::find(study.conditions, name, &Study::Condition::name) != study.conditions.end()) {
            entry.refuse("name", name,
                         "a different word for each condition: letters, digits, '_', '-' and '.'");
        }
        entry.finish();
        study.conditions.push_back({name, scenario});
    }
    if (study.conditions.empty()) {
        root.refuse("conditions", "none", "a list with at least one condition");
    }
}

void read_participants(YamlMap& root, Study& study, std::uint64_t seed) {
    for (YamlMap& entry : root.list("participants")) {
        const int count = entry.whole("count", 1, 1, most_participants);
        Study::Participant one;
        one.operator_ = entry.name("operator", "");
        for (const char* key : {"skill", "skill_to", "attempts"}) {
            if (one.operator_.empty() && entry.has(key)) {
                entry.refuse(key, "a value for people",
                             "it beside 'operator'; human participants have their own skill");
            }
        }
        const float skill = entry.number("skill", 1.0f, {0, 1});
        const float skill_to = entry.number("skill_to", skill, {0, 1});
        if (entry.has("skill_to") && !entry.has("skill")) {
            entry.refuse("skill_to", "a value without 'skill'", "both, or only 'skill'");
        }
        if (entry.has("attempts")) {
            one.attempts = entry.whole("attempts", 1, 1, max_attempts);
        }
        for (int i = 0; i < count; ++i) {
            if (entry.has("skill")) {
                // Evenly spaced from one to the other; a single one gets the first.
                const float share = count > 1 ? static_cast<float>(i) / static_cast<float>(count - 1) : 0.0f;
                one.skill = skill + share * (skill_to - skill);
            }
            study.participants.push_back(one);
        }
        entry.finish();
    }
    if (study.participants.empty() || study.participants.size() > most_participants) {
        root.refuse(
            "participants", std::to_string(study.participants.size()),
            fmt::format(
                "a list of 1 to {} participants: - {{count: 12}}, or - {{count: 12, operator: expert}}",
                most_participants));
    }
    for (std::size_t i = 0; i < study.participants.size(); ++i) {
        study.participants[i].name = fmt::format("P{:0{}}", i + 1, study.participants.size() < 100 ? 2 : 3);
        study.participants[i].seed = seed + i;
    }
}

void read_expectations(YamlMap& root, Study& study) {
    const auto known = [&](const std::string& name) {
        return std::ranges::find(study.conditions, name, &Study::Condition::name) != study.conditions.end();
    };
    for (YamlMap& entry : root.list("expect")) {
        Expectation one;
        one.measure = entry.name("measure", "");
        if (std::ranges::find(measures(), one.measure, &Measure::key) == measures().end()) {
            entry.refuse("measure", one.measure,
                         "the key of a metric as listed in docs/metrics.md, or success_percent");
        }
        one.source = entry.text("source", "");
        if (entry.has("group")) {
            one.group = entry.name("group", "");
            if (!known(one.group)) {
                entry.refuse("group", one.group, "the name of a condition");
            }
            const Range any{-1e6f, 1e6f};
            one.low = static_cast<double>(entry.number("low", any.low, any));
            one.high = static_cast<double>(entry.number("high", any.high, any));
        } else {
            for (const auto& [key, value] : {std::pair("from", &one.from), {"to", &one.to}}) {
                *value = entry.name(key, "");
                if (!known(*value)) {
                    entry.refuse(key, *value, "the name of a condition");
                }
            }
            one.more = entry.choice("is", 0, directions) == 0;
        }
        entry.finish();
        study.expectations.push_back(std::move(one));
    }
}

}  // namespace

Study load_study(const std::filesystem::path& file) {
    Study study;
    study.text = read_text_file(file);
    YamlMap root = YamlMap::parse(study.text, file.string());
    study.name = root.name("name", file.stem().string());
    study.description = root.text("description", "");
    study.latin_square = root.choice("order", 0, orders) == 0;
    const std::uint64_t seed = root.seed("seed", 1);
    read_conditions(root, study, file.parent_path());
    read_participants(root, study, seed);
    read_expectations(root, study);
    root.finish();
    return study;
}

std::vector<std::vector<std::size_t>> balanced_orders(std::size_t count) {
    std::vector<std::vector<std::size_t>> orders_found;
    for (std::size_t row = 0; row < count; ++row) {
        // 0, 1, n-1, 2, n-2, ...: all differences of neighbours are distinct.
        std::vector<std::size_t> order;
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t first = i % 2 == 1 ? (i + 1) / 2 : (count - i / 2) % count;
            order.push_back((first + row) % count);
        }
        orders_found.push_back(std::move(order));
    }
    if (count % 2 == 1 && count > 1) {
        for (std::size_t row = 0; row < count; ++row) {
            orders_found.emplace_back(orders_found[row].rbegin(), orders_found[row].rend());
        }
    }
    return orders_found;
}

std::vector<PlannedSession> plan_of(const Study& study) {
    const auto squares = balanced_orders(study.conditions.size());
    std::vector<PlannedSession> plan;
    for (std::size_t p = 0; p < study.participants.size(); ++p) {
        for (std::size_t place = 0; place < study.conditions.size(); ++place) {
            const std::size_t condition = study.latin_square ? squares[p % squares.size()][place] : place;
            const Study::Condition& of = study.conditions[condition];
            plan.push_back({&study.participants[p], &of, place + 1,
                            std::filesystem::path(of.name) / (study.participants[p].name + ".eti.h5")});
        }
    }
    return plan;
}

std::vector<ExpectationResult> check_expectations(const Comparison& comparison,
                                                  const std::vector<Expectation>& expectations) {
    const auto group_of = [&](const std::string& name) {
        return static_cast<std::size_t>(std::ranges::find(comparison.groups, name, &StudyGroup::name) -
                                        comparison.groups.begin());
    };
    std::vector<ExpectationResult> verdicts;
    for (const Expectation& expected : expectations) {
        ExpectationResult& verdict = verdicts.emplace_back();
        verdict.expected = expected;
        const auto row = std::ranges::find_if(
            comparison.rows, [&](const MeasureRow& one) { return one.measure->key == expected.measure; });
        if (row == comparison.rows.end()) {
            continue;
        }
        using enum ExpectationResult::Finding;
        if (expected.is_range()) {
            const std::size_t group = group_of(expected.group);
            if (group == comparison.groups.size() || row->groups[group].count == 0) {
                continue;
            }
            const double mean = row->groups[group].mean;
            verdict.finding = mean >= expected.low && mean <= expected.high ? agrees : disagrees;
            verdict.found = fmt::format("mean {:.2f}", mean);
            continue;
        }
        const std::size_t from = group_of(expected.from), to = group_of(expected.to);
        const auto contrast = std::ranges::find_if(row->contrasts, [&](const Contrast& one) {
            return (one.first == from && one.second == to) || (one.first == to && one.second == from);
        });
        if (contrast == row->contrasts.end() || !std::isfinite(contrast->difference.value)) {
            continue;
        }
        // Positive in the expected direction.
        const double sign = (contrast->first == from ? 1.0 : -1.0) * (expected.more ? 1.0 : -1.0);
        const Interval& range = contrast->difference.interval;
        const double near = sign > 0.0 ? range.low : -range.high, far = sign > 0.0 ? range.high : -range.low;
        verdict.finding = near > 0.0 ? agrees : far < 0.0 ? disagrees : undecided;
        const double shown = contrast->first == from ? 1.0 : -1.0;
        verdict.found = fmt::format("{:+.2f}", shown * contrast->difference.value);
        if (std::isfinite(range.low)) {
            verdict.found += fmt::format(" ({:.2f} to {:.2f})", shown > 0.0 ? range.low : -range.high,
                                         shown > 0.0 ? range.high : -range.low);
        }
    }
    return verdicts;
}

namespace {

std::string expected_text(const Expectation& expected) {
    return expected.is_range()
               ? fmt::format("{:.4g} to {:.4g} in {}", expected.low, expected.high, expected.group)
               : fmt::format("{} in {} than in {}", expected.more ? "more" : "less", expected.to,
                             expected.from);
}

}  // namespace

std::string to_table(const std::vector<ExpectationResult>& verdicts) {
    std::string out =
        fmt::format("  {:<28}{:<36}{:<28}\n", "Compared with published results", "expected", "found");
    for (const ExpectationResult& verdict : verdicts) {
        out +=
            fmt::format("  {:<28}{:<36}{:<28}{}\n", verdict.expected.measure, expected_text(verdict.expected),
                        verdict.found, verdict_words[static_cast<std::size_t>(verdict.finding)]);
    }
    std::vector<std::string> sources;
    for (const ExpectationResult& verdict : verdicts) {
        if (!verdict.expected.source.empty() &&
            std::ranges::find(sources, verdict.expected.source) == sources.end()) {
            sources.push_back(verdict.expected.source);
        }
    }
    for (const std::string& source : sources) {
        out += fmt::format("Source: {}\n", source);
    }
    return out;
}

nlohmann::ordered_json to_json(const std::vector<ExpectationResult>& verdicts) {
    auto out = nlohmann::ordered_json::array();
    for (const ExpectationResult& verdict : verdicts) {
        out.push_back({{"measure", verdict.expected.measure},
                       {"expected", expected_text(verdict.expected)},
                       {"found", verdict.found},
                       {"verdict", verdict_words[static_cast<std::size_t>(verdict.finding)]},
                       {"source", verdict.expected.source}});
    }
    return out;
}

std::string to_html(const std::vector<ExpectationResult>& verdicts) {
    std::string rows;
    for (const ExpectationResult& verdict : verdicts) {
        rows +=
            fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                        html_text(verdict.expected.measure), html_text(expected_text(verdict.expected)),
                        html_text(verdict.found), verdict_words[static_cast<std::size_t>(verdict.finding)],
                        html_text(verdict.expected.source));
    }
    return rows.empty() ? ""
                        : "<h2>Compared with published results</h2>\n<div "
                          "class=\"wide\"><table>\n<tr><th>Measure</th><th>expected</th><th>found</th><th></"
                          "th><th>source</th></tr>\n" +
                              rows + "</table></div>\n";
}

}  // namespace eti::review
