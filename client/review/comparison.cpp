// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/comparison.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace eti::review {

namespace {

std::vector<double> values_of(const StudyGroup& group, const Measure& measure) {
    std::vector<double> values;
    for (const StudySession& session : group.sessions) {
        if (const double value = measure.of(session); std::isfinite(value)) {
            values.push_back(value);
        }
    }
    return values;
}

/// Sessions by participant. Throws on duplicates.
std::map<std::string, const StudySession*> by_participant(const StudyGroup& group) {
    std::map<std::string, const StudySession*> sessions;
    for (const StudySession& session : group.sessions) {
        const auto [at, added] = sessions.emplace(session.participant, &session);
        if (!added) {
            throw ComparisonError(fmt::format(
                "group {}: {} and {} are both of participant {}; --paired expects one session per "
                "participant: omit one of them",
                group.name, at->second->file.string(), session.file.string(), session.participant));
        }
    }
    return sessions;
}

/// Paired sessions, in the order of the groups.
using Pairs = std::vector<std::vector<const StudySession*>>;

Pairs pair_up(Comparison& comparison) {
    std::size_t named = 0, all = 0;
    for (const StudyGroup& group : comparison.groups) {
        for (const StudySession& session : group.sessions) {
            ++all;
            named += session.participant.empty() ? 0 : 1;
        }
    }
    Pairs pairs;
    if (named == 0) {
        const std::size_t count = comparison.groups.front().sessions.size();
        for (const StudyGroup& group : comparison.groups) {
            if (group.sessions.size() != count) {
                throw ComparisonError(fmt::format(
                    "--paired: {} sessions in group {}, {} in {}; as no file names its participant, expected "
                    "equally many in the same order: give such files, or record with --participant",
                    count, comparison.groups.front().name, group.sessions.size(), group.name));
            }
        }
        for (std::size_t i = 0; i < count; ++i) {
            auto& pair = pairs.emplace_back();
            for (const StudyGroup& group : comparison.groups) {
                pair.push_back(&group.sessions[i]);
            }
        }
        comparison.remarks.emplace_back("paired in the order of the files, as no file names its participant");
        return pairs;
    }
    if (named != all) {
        throw ComparisonError(
            fmt::format("--paired: {} of {} files name no participant; expected one in each file or in none: "
                        "omit these files, or omit --paired",
                        all - named, all));
    }
    std::vector<std::map<std::string, const StudySession*>> sessions;
    std::set<std::string> participants;
    for (const StudyGroup& group : comparison.groups) {
        sessions.push_back(by_participant(group));
        for (const auto& [participant, session] : sessions.back()) {
            participants.insert(participant);
        }
    }
    for (const std::string& participant : participants) {
        std::vector<const StudySession*> pair;
        for (std::size_t i = 0; i < sessions.size(); ++i) {
            const auto found = sessions[i].find(participant);
            if (found == sessions[i].end()) {
                comparison.remarks.push_back(
                    fmt::format("participant {} is excluded from differences: no session in group {}",
                                participant, comparison.groups[i].name));
                break;
            }
            pair.push_back(found->second);
        }
        if (pair.size() == sessions.size()) {
            pairs.push_back(std::move(pair));
        }
    }
    return pairs;
}

Contrast contrast(const Comparison& comparison, const Pairs& pairs, const Measure& measure, std::size_t first,
                  std::size_t second) {
    Contrast out{first, second, 0, {}, no_value};
    if (!comparison.paired) {
        out.difference = difference_between(values_of(comparison.groups[first], measure),
                                            values_of(comparison.groups[second], measure), comparison.how);
        return out;
    }
    std::vector<double> differences;
    for (const auto& pair : pairs) {
        const double difference = measure.of(*pair[second]) - measure.of(*pair[first]);
        if (std::isfinite(difference)) {
            differences.push_back(difference);
        }
    }
    out.pairs = differences.size();
    out.difference = difference_within(differences, comparison.how);
    return out;
}

/// Between two groups the paper's measures form one family of tests, the others another.
void adjust(std::vector<MeasureRow>& rows) {
    const std::size_t contrasts = rows.empty() ? 0 : rows.front().contrasts.size();
    for (std::size_t c = 0; c < contrasts; ++c) {
        for (const bool in_paper : {true, false}) {
            std::vector<double> p;
            std::vector<double*> into;
            for (MeasureRow& row : rows) {
                if (row.measure->in_paper == in_paper) {
                    p.push_back(row.contrasts[c].difference.p);
                    into.push_back(&row.contrasts[c].p_adjusted);
                }
            }
            const std::vector<double> adjusted = holm_adjusted(p);
            for (std::size_t i = 0; i < into.size(); ++i) {
                *into[i] = adjusted[i];
            }
        }
    }
}

/// Below this size the tests hold their level by missing differences (docs/decisions/studies.md).
constexpr std::size_t small = 10;

/// Forces and view depend on it.
void remark_on_mixed_quality(Comparison& comparison) {
    std::size_t reduced = 0, all = 0;
    for (const StudyGroup& group : comparison.groups) {
        for (const StudySession& session : group.sessions) {
            reduced += session.info.text(session::quality_text) == "reduced" ? 1 : 0;
            ++all;
        }
    }
    if (reduced > 0 && reduced < all) {
        comparison.remarks.push_back(fmt::format(
            "{} of {} sessions were simulated at reduced quality, on slower machines: compare only "
            "sessions of one quality, which eti-server --quality sets",
            reduced, all));
    }
}

void remark_on_small_samples(Comparison& comparison, std::size_t pairs) {
    constexpr const char* advice =
        "fewer than 10 find large differences only: 'undecided' does not mean that there is none";
    if (comparison.paired && pairs < small) {
        comparison.remarks.push_back(fmt::format("{} pairs: {}", pairs, advice));
    }
    for (const StudyGroup& group : comparison.groups) {
        if (!comparison.paired && group.sessions.size() < small) {
            comparison.remarks.push_back(
                fmt::format("{} sessions in group {}: {}", group.sessions.size(), group.name, advice));
        }
    }
}

}  // namespace

double Measure::of(const StudySession& session) const {
    if (value != nullptr) {
        return session.metrics.*value;
    }
    return !session.outcome.known ? no_value : session.outcome.success ? 100.0 : 0.0;
}

const std::vector<Measure>& measures() {
    static const std::vector<Measure> all = [] {
        std::vector<Measure> list;
        for (const MetricField& field : metric_fields) {
            list.push_back({field.key, field.label, field.unit, field.in_paper, field.value});
        }
        const auto beyond = std::ranges::find(list, false, &Measure::in_paper);
        list.insert(beyond, {"success_percent", "trachea intubated", "%", false, nullptr});
        return list;
    }();
    return all;
}

Comparison read_groups(const GroupFiles& files,
                       const std::function<void(const std::filesystem::path&)>& progress) {
    Comparison comparison;
    std::map<std::filesystem::path, std::string> seen;
    for (const auto& [name, paths] : files) {
        if (std::ranges::find(comparison.groups, name, &StudyGroup::name) != comparison.groups.end()) {
            throw ComparisonError(fmt::format("--group {}: given twice; give each group its own name", name));
        }
        StudyGroup& group = comparison.groups.emplace_back(name, std::vector<StudySession>{});
        for (const std::filesystem::path& path : paths) {
            progress(path);
            Summary summary = summarise(path);
            const auto [at, added] = seen.emplace(std::filesystem::canonical(path), name);
            if (!added) {
                throw ComparisonError(fmt::format(
                    "{}: in group {} and again in group {}; a session counts once: omit one of them",
                    path.string(), at->second, name));
            }
            if (!summary.has_run) {
                comparison.remarks.push_back(fmt::format("{} is excluded from group {}: {}", path.string(),
                                                         name, summary.run.outcome.reason));
                continue;
            }
            group.sessions.push_back({path, summary.info, summary.info.text(session::participant_text),
                                      summary.run.metrics, summary.run.outcome});
        }
        if (group.sessions.empty()) {
            throw ComparisonError(
                fmt::format("--group {}: no session with a known outcome among {} files; expected at least "
                            "one: give files with complete recordings",
                            name, paths.size()));
        }
    }
    if (comparison.groups.size() < 2) {
        throw ComparisonError(
            "compare: one group; expected at least two: --group NAME FILE... --group NAME FILE...");
    }
    return comparison;
}

void compare(Comparison& comparison) {
    const Pairs pairs = comparison.paired ? pair_up(comparison) : Pairs{};
    if (comparison.paired && pairs.size() < 2) {
        throw ComparisonError(
            fmt::format("--paired: {} participants have a session in every group; expected at least two: "
                        "give more files, or omit --paired",
                        pairs.size()));
    }
    remark_on_mixed_quality(comparison);
    remark_on_small_samples(comparison, pairs.size());
    for (const Measure& measure : measures()) {
        MeasureRow row{&measure, {}, {}};
        std::size_t found = 0;
        for (const StudyGroup& group : comparison.groups) {
            const std::vector<double> values = values_of(group, measure);
            row.groups.push_back({values.size(), mean_of(values), standard_deviation(values)});
            found += values.size();
        }
        if (found == 0) {
            continue;
        }
        for (std::size_t first = 0; first < comparison.groups.size(); ++first) {
            for (std::size_t second = first + 1; second < comparison.groups.size(); ++second) {
                row.contrasts.push_back(contrast(comparison, pairs, measure, first, second));
            }
        }
        comparison.rows.push_back(std::move(row));
    }
    adjust(comparison.rows);
}

}  // namespace eti::review
