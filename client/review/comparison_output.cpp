// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "client/review/comparison.hpp"
#include "client/review/output.hpp"
#include "common/model/utf8.hpp"

namespace eti::review {

namespace {

using nlohmann::ordered_json;

/// Three digits, or two decimals: the precision that samples of this size support.
std::string number(double value) {
    if (!std::isfinite(value)) {
        return "-";
    }
    const double shown = std::abs(value) < 0.005 ? 0.0 : value;  // no negative zero
    return fmt::format("{:.{}f}", shown, std::abs(value) < 99.95 ? 2 : 1);
}

std::string chance(double p) {
    return !std::isfinite(p) ? "-" : p < 0.001 ? "<0.001" : fmt::format("{:.3f}", p);
}

/// `sessions`: size of the group; if fewer have the value, the text states their number.
std::string mean_text(const MeasureRow::Cell& cell, std::size_t sessions) {
    if (cell.count == 0) {
        return "-";
    }
    std::string out = std::isfinite(cell.deviation)
                          ? fmt::format("{} ({})", number(cell.mean), number(cell.deviation))
                          : number(cell.mean);
    return cell.count < sessions ? out + fmt::format(" n={}", cell.count) : out;
}

std::string interval_text(const Interval& interval) {
    return std::isfinite(interval.low) ? fmt::format("{} to {}", number(interval.low), number(interval.high))
                                       : "-";
}

std::string pair_name(const Comparison& comparison, const Contrast& contrast) {
    return fmt::format("{} minus {}", comparison.groups[contrast.second].name,
                       comparison.groups[contrast.first].name);
}

std::string how_text(const Comparison& comparison) {
    return fmt::format(
        "{} Intervals are {:.0f} % ({} resamples, seed {}).",
        comparison.paired ? "Differences are within participants." : "Groups are treated as independent.",
        100.0 * comparison.how.level, comparison.how.resamples, comparison.how.seed);
}

constexpr std::string_view legend =
    "p: bootstrap test of no difference, and its interval; Holm: p adjusted for the number of metrics in its "
    "part; g: Hedges' "
    "effect size";

/// Rows of the paper's metrics, then the others, with a heading between.
template <class Each, class Between>
void in_two_parts(const Comparison& comparison, const Each& each, const Between& between) {
    for (const bool in_paper : {true, false}) {
        if (!in_paper &&
            std::ranges::any_of(comparison.rows, [](const auto& row) { return !row.measure->in_paper; })) {
            between();
        }
        for (const MeasureRow& row : comparison.rows) {
            if (row.measure->in_paper == in_paper) {
                each(row);
            }
        }
    }
}

ordered_json interval_json(const Interval& interval) {
    return {number_or_null(interval.low), number_or_null(interval.high)};
}

/// The effect and its interval as a line with a dot, from -3 to 3 standard deviations.
std::string effect_picture(const Difference& difference) {
    if (!std::isfinite(difference.effect)) {
        return "";
    }
    const auto x = [](double effect) { return 75.0 + 24.0 * std::clamp(effect, -3.0, 3.0); };
    const Interval& range = difference.effect_interval;
    const Interval shown = std::isfinite(range.low) ? range : Interval{difference.effect, difference.effect};
    return fmt::format(
        "<svg viewBox=\"0 0 150 14\" width=\"150\" height=\"14\" role=\"img\" aria-label=\"effect {} ({})\">"
        "<path d=\"M75 0V14\" stroke=\"#97a2ad\"/><path d=\"M{:.1f} 7H{:.1f}\" stroke=\"#0b5cad\" "
        "stroke-width=\"2\"/>"
        "<circle cx=\"{:.1f}\" cy=\"7\" r=\"3.5\" fill=\"#0b5cad\"/></svg>",
        number(difference.effect), interval_text(range), x(shown.low), x(shown.high), x(difference.effect));
}

}  // namespace

std::string to_table(const Comparison& comparison) {
    // The text in brackets is explained in metrics.md.
    const auto label = [](const MeasureRow& row) {
        return row.measure->label.substr(0, row.measure->label.find(" ("));
    };
    std::size_t label_width = 0;
    for (const MeasureRow& row : comparison.rows) {
        label_width = std::max(label_width, label(row).size());
    }
    const auto begin = [&](const MeasureRow& row) {
        return fmt::format("  {:<{}}  {:<5}", label(row), label_width, row.measure->unit);
    };
    std::string out;
    constexpr std::size_t groups_abreast = 3;
    for (std::size_t from = 0; from < comparison.groups.size(); from += groups_abreast) {
        const std::size_t to = std::min(comparison.groups.size(), from + groups_abreast);
        out += fmt::format("  {:<{}}", "Mean (standard deviation)", label_width + 7);
        for (std::size_t g = from; g < to; ++g) {
            const StudyGroup& group = comparison.groups[g];
            out += fmt::format(
                "{:>21}", fmt::format("{} n={}", group.name.substr(0, utf8_prefix_length(group.name, 13)),
                                      group.sessions.size()));
        }
        out += '\n';
        in_two_parts(
            comparison,
            [&](const MeasureRow& row) {
                out += begin(row);
                for (std::size_t g = from; g < to; ++g) {
                    out +=
                        fmt::format("{:>21}", mean_text(row.groups[g], comparison.groups[g].sessions.size()));
                }
                out += '\n';
            },
            [&] { out += "  Beyond the paper\n"; });
        out += '\n';
    }
    const std::size_t contrasts = comparison.rows.empty() ? 0 : comparison.rows.front().contrasts.size();
    for (std::size_t c = 0; c < contrasts; ++c) {
        out += fmt::format("  {}\n  {:<{}}{:>9}{:>19}{:>8}{:>8}{:>7}{:>17}\n",
                           pair_name(comparison, comparison.rows.front().contrasts[c]), "Difference",
                           label_width + 7, "", "interval", "p", "Holm", "g", "interval");
        in_two_parts(
            comparison,
            [&](const MeasureRow& row) {
                const Contrast& one = row.contrasts[c];
                out += fmt::format(
                    "{}{:>9}{:>19}{:>8}{:>8}{:>7}{:>17}\n", begin(row), number(one.difference.value),
                    interval_text(one.difference.interval), chance(one.difference.p), chance(one.p_adjusted),
                    number(one.difference.effect), interval_text(one.difference.effect_interval));
            },
            [&] { out += "  Beyond the paper\n"; });
        out += '\n';
    }
    out += fmt::format("{}\n{}.\n", how_text(comparison), legend);
    for (const std::string& remark : comparison.remarks) {
        out += fmt::format("Note: {}\n", remark);
    }
    return out;
}

ordered_json to_json(const Comparison& comparison) {
    ordered_json out;
    out["paired"] = comparison.paired;
    out["resamples"] = comparison.how.resamples;
    out["seed"] = comparison.how.seed;
    out["level"] = comparison.how.level;
    out["groups"] = ordered_json::array();
    for (const StudyGroup& group : comparison.groups) {
        ordered_json files = ordered_json::array();
        for (const StudySession& session : group.sessions) {
            files.push_back(session.file.string());
        }
        out["groups"].push_back({{"name", group.name}, {"files", files}});
    }
    out["measures"] = ordered_json::array();
    for (const MeasureRow& row : comparison.rows) {
        ordered_json one{{"key", row.measure->key},         {"label", row.measure->label},
                         {"unit", row.measure->unit},       {"in_paper", row.measure->in_paper},
                         {"groups", ordered_json::array()}, {"differences", ordered_json::array()}};
        for (const MeasureRow::Cell& cell : row.groups) {
            one["groups"].push_back({{"count", cell.count},
                                     {"mean", number_or_null(cell.mean)},
                                     {"deviation", number_or_null(cell.deviation)}});
        }
        for (const Contrast& contrast : row.contrasts) {
            const Difference& d = contrast.difference;
            ordered_json entry{{"from", comparison.groups[contrast.first].name},
                               {"to", comparison.groups[contrast.second].name}};
            if (comparison.paired) {
                entry["pairs"] = contrast.pairs;
            }
            entry["difference"] = number_or_null(d.value);
            entry["interval"] = interval_json(d.interval);
            entry["p"] = number_or_null(d.p);
            entry["p_holm"] = number_or_null(contrast.p_adjusted);
            entry["hedges_g"] = number_or_null(d.effect);
            entry["hedges_g_interval"] = interval_json(d.effect_interval);
            one["differences"].push_back(std::move(entry));
        }
        out["measures"].push_back(std::move(one));
    }
    out["remarks"] = comparison.remarks;
    return out;
}

std::string to_csv(const Comparison& comparison) {
    std::string out = "file,group,participant,scenario,operator,seed,success";
    for (const MetricField& field : metric_fields) {
        out += fmt::format(",{}", field.key);
    }
    out += "\r\n";
    for (const StudyGroup& group : comparison.groups) {
        for (const StudySession& session : group.sessions) {
            out += fmt::format("{},{},{},{},{},{},{}", csv_text(session.file.string()), csv_text(group.name),
                               csv_text(session.participant), csv_text(session.info.scenario),
                               csv_text(session.info.operator_name), session.info.seed,
                               !session.outcome.known    ? ""
                               : session.outcome.success ? "1"
                                                         : "0");
            for (const MetricField& field : metric_fields) {
                const double value = session.metrics.*field.value;
                out += std::isfinite(value) ? fmt::format(",{:.9g}", value) : ",";
            }
            out += "\r\n";
        }
    }
    return out;
}

std::string to_html(const Comparison& comparison, std::string_view extra_html) {
    std::string out = fmt::format(
        "<h1>Comparison</h1>\n<p class=\"soft\">{} {}. Bold: Holm-adjusted p below 0.05. NeoETI {}.</p>\n",
        html_text(how_text(comparison)), html_text(legend), html_text(ETI_VERSION));
    out +=
        "<h2>Mean (standard deviation)</h2>\n<div class=\"wide\"><table>\n<tr><th>Measure</th><th>unit</th>";
    for (const StudyGroup& group : comparison.groups) {
        out += fmt::format("<th>{} (n = {})</th>", html_text(group.name), group.sessions.size());
    }
    out += "</tr>\n";
    const auto part = [&] { out += "<tr class=\"part\"><th colspan=\"99\">Beyond the paper</th></tr>\n"; };
    in_two_parts(
        comparison,
        [&](const MeasureRow& row) {
            out += fmt::format("<tr><td>{}</td><td>{}</td>", html_text(row.measure->label),
                               html_text(row.measure->unit));
            for (std::size_t g = 0; g < row.groups.size(); ++g) {
                out += fmt::format("<td>{}</td>",
                                   mean_text(row.groups[g], comparison.groups[g].sessions.size()));
            }
            out += "</tr>\n";
        },
        part);
    out += "</table></div>\n";
    const std::size_t contrasts = comparison.rows.empty() ? 0 : comparison.rows.front().contrasts.size();
    for (std::size_t c = 0; c < contrasts; ++c) {
        out += fmt::format(
            "<h2>{}</h2>\n<div class=\"wide\"><table>\n<tr><th>Measure</th><th>unit</th><th>difference</th>"
            "<th>interval</th><th>p</th><th>Holm</th><th>g</th><th>interval</th><th>-3 to 3</th></tr>\n",
            html_text(pair_name(comparison, comparison.rows.front().contrasts[c])));
        in_two_parts(
            comparison,
            [&](const MeasureRow& row) {
                const Contrast& one = row.contrasts[c];
                out += fmt::format(
                    "<tr{}><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>"
                    "<td>{}</td><td>{}</td></tr>\n",
                    one.p_adjusted < 0.05 ? " class=\"distinct\"" : "", html_text(row.measure->label),
                    html_text(row.measure->unit), number(one.difference.value),
                    interval_text(one.difference.interval), html_text(chance(one.difference.p)),
                    html_text(chance(one.p_adjusted)), number(one.difference.effect),
                    interval_text(one.difference.effect_interval), effect_picture(one.difference));
            },
            part);
        out += "</table></div>\n";
    }
    out += extra_html;
    out += "<h2>Sessions</h2>\n<ul>\n";
    for (const StudyGroup& group : comparison.groups) {
        for (const StudySession& session : group.sessions) {
            out += fmt::format("<li>{}: {}{}{}</li>\n", html_text(group.name),
                               html_text(session.file.filename().string()),
                               session.participant.empty() ? "" : ", " + html_text(session.participant),
                               session.outcome.success ? ", intubated" : "");
        }
    }
    for (const std::string& remark : comparison.remarks) {
        out += fmt::format("<li>Note: {}</li>\n", html_text(remark));
    }
    return html_page("NeoETI comparison", out + "</ul>\n");
}

}  // namespace eti::review
