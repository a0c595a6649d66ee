// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/report.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <span>

#include "client/review/output.hpp"
#include "client/text/catalogue.hpp"
#include "client/text/server_sentences.hpp"
#include "common/model/aims.hpp"
#include "common/scenario/scenario.hpp"

namespace eti::review {

namespace {

using nlohmann::ordered_json;
using text::translate;
using Steps = std::span<const session::StepRecord>;

/// Number of items that a person can keep in mind.
constexpr std::size_t max_practice_items = 3;

/// Values at the start of the session, reference for decreases.
AttemptMetrics first_values(Steps steps) {
    for (const session::StepRecord& step : steps) {
        if (std::isfinite(step.metrics.oxygen_saturation_end_percent)) {
            return step.metrics;
        }
    }
    return initial_metrics();
}

/// The record of a session's run or attempts that a target refers to.
const session::SummaryRecord& judged(const Aim& aim, const session::SummaryRecord& record,
                                     const Summary& summary, const AttemptMetrics& first) {
    const session::SummaryRecord* worst = &record;
    if (aim.each_attempt && record.attempt == 0) {
        for (const session::SummaryRecord& attempt : summary.attempts) {
            if (worst->attempt == 0 ||
                !(shortfall(aim, attempt.metrics, first) <= shortfall(aim, worst->metrics, first))) {
                worst = &attempt;
            }
        }
    }
    return *worst;
}

ordered_json record_json(const session::SummaryRecord& record, const Summary& summary,
                         const AttemptMetrics& first) {
    ordered_json out;
    out["attempt"] = record.attempt;
    out["success"] = summary.outcome_known(record) ? ordered_json(record.outcome.success) : ordered_json();
    out["reason"] = text::translate_sentence(record.outcome.reason);
    for (const MetricField& field : metric_fields) {
        const auto aim = std::ranges::find(aims, field.key, &Aim::key);
        out["values"].push_back(record.metrics.*field.value);
        out["lights"].push_back(
            aim == aims.end()
                ? ""
                : name_of(aim_status(shortfall(*aim, judged(*aim, record, summary, first).metrics, first))));
    }
    return out;
}

template <class Value>
double time_of_greatest(Steps steps, const Value& value) {
    const auto most = std::ranges::max_element(steps, {}, [&](const session::StepRecord& step) {
        const float number = value(step);
        return std::isnan(number) ? -1.0f : number;
    });
    return most == steps.end() ? 0.0 : seconds_of(*most);
}

double time_of_best_view(Steps steps) {
    return time_of_greatest(steps, [](const auto& step) { return step.measures.glottic_opening_percent; });
}

/// The most informative pictures; only moments that occurred.
ordered_json moments_json(Steps steps) {
    ordered_json out = ordered_json::array();
    const auto some = [&](auto&& predicate) { return std::ranges::any_of(steps, predicate); };
    if (some([](const auto& step) { return step.measures.glottic_opening_percent > 0; })) {
        out.push_back(
            {{"label", translate("Best view of the glottis")}, {"time_s", time_of_best_view(steps)}});
    }
    const auto passed = std::ranges::find_if(
        steps, [](const auto& step) { return step.measures.tube_depth_past_glottis > 0; });
    if (passed != steps.end()) {
        out.push_back({{"label", translate("The tube passes the glottis")}, {"time_s", seconds_of(*passed)}});
    }
    if (some([](const auto& step) { return step.measures.gum_force_n > 0; })) {
        out.push_back({{"label", translate("Greatest force on the upper gum")},
                       {"time_s", time_of_greatest(
                                      steps, [](const auto& step) { return step.measures.gum_force_n; })}});
    }
    return out;
}

double moment_of(const Aim& aim, Steps steps, const session::SummaryRecord& record,
                 const AttemptMetrics& first) {
    const auto when = [&](auto&& predicate) {
        const auto found = std::ranges::find_if(steps, predicate);
        return found == steps.end() ? seconds_of(steps.back()) : seconds_of(*found);
    };
    switch (aim.moment) {
        case AimMoment::best_view:
            return time_of_best_view(steps);
        case AimMoment::second_attempt:
            return when([](const auto& step) { return step.attempt > 1; });
        case AimMoment::end:
            for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
                if (step->attempt_running) {
                    return seconds_of(*step);
                }
            }
            return seconds_of(steps.back());
        case AimMoment::crossed:
            break;
    }
    return when([&](const session::StepRecord& step) {
        return step.attempt_running && (record.attempt == 0 || step.attempt == record.attempt) &&
               shortfall(aim, step.metrics, first) > 0.0;
    });
}

/// The targets missed by the widest margin.
ordered_json practise_json(const Summary& summary, Steps steps, const AttemptMetrics& first) {
    struct Miss {
        const Aim* aim;
        const session::SummaryRecord* record;
        double by;
    };
    std::vector<Miss> misses;
    for (const Aim& aim : aims) {
        const session::SummaryRecord& record = judged(aim, summary.run, summary, first);
        const double by = shortfall(aim, record.metrics, first);
        if (by > 0.0 && !aim.practise.empty() && !steps.empty()) {
            misses.push_back({&aim, &record, by});
        }
    }
    std::ranges::stable_sort(misses, std::ranges::greater{}, &Miss::by);
    misses.resize(std::min(misses.size(), max_practice_items));
    ordered_json out = ordered_json::array();
    for (const Miss& miss : misses) {
        out.push_back({{"key", miss.aim->key},
                       {"value", miss.record->metrics.*metric_field(miss.aim->key).value},
                       {"light", name_of(aim_status(miss.by))},
                       {"practise", translate(miss.aim->practise)},
                       {"time_s", moment_of(*miss.aim, steps, *miss.record, first)}});
    }
    return out;
}

/// Steps per sample of the time line.
std::size_t stride_of(std::size_t steps) {
    constexpr std::size_t to_30_hz = 6;
    return std::max(to_30_hz, (steps + max_samples - 1) / max_samples);
}

/// Rounded to the precision of a chart.
double shortened(double value) {
    return std::round(1e4 * value) * 1e-4;
}

/// A value of several steps, as shown.
double sample_of(Steps part, const LiveMeasureField& field) {
    float value = part.back().measures.*field.value;
    for (const session::StepRecord& step : part) {
        value = field.peaks ? std::fmax(value, step.measures.*field.value) : value;
    }
    return shortened(static_cast<double>(value / field.per_unit));
}

ordered_json samples_json(Steps steps) {
    const std::size_t stride = stride_of(steps.size());
    std::vector<Steps> parts;
    ordered_json time = ordered_json::array(), lines = time;
    for (std::size_t from = 0; from < steps.size(); from += stride) {
        parts.push_back(steps.subspan(from, std::min(stride, steps.size() - from)));
        time.push_back(seconds_of(parts.back().back()));
    }
    for (const LiveMeasureField& field : live_measure_fields) {
        if (field.plot_high > 0.0f) {
            ordered_json values = ordered_json::array();
            for (const Steps part : parts) {
                values.push_back(sample_of(part, field));
            }
            std::string label(translate(field.label));
            label[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(label[0])));
            lines.push_back({{"label", label}, {"unit", field.unit}, {"values", std::move(values)}});
        }
    }
    return {{"time_s", std::move(time)}, {"lines", std::move(lines)}};
}

ordered_json score_json(const ScoreModel& model, const Summary& summary) {
    ordered_json out = to_json(score_of(model, summary.run.metrics, summary.run.outcome.success), model);
    out["statement"] = text::translate_sentence(out["statement"].get<std::string>());
    for (ordered_json& one : out["contributions"]) {
        const std::string label = one["label"];
        one["label"] = translate(label);
    }
    return out;
}

void replace_once(std::string& text, std::string_view old, std::string_view by) {
    if (const std::size_t at = text.find(old); at != std::string::npos) {
        text.replace(at, old.size(), by);
    }
}

/// The page with its own texts in the selected language.
std::string translated_page() {
    std::string page(report_page());
    ordered_json texts = ordered_json::object();
    for (const auto& [english, translated] : text::entries()) {
        texts[std::string(english)] = translated;
    }
    replace_once(page, "<!--texts-->", escape_for_script(texts));
    replace_once(page, "lang=\"en\"", fmt::format("lang=\"{}\"", text::language()));
    for (const std::string_view english :
         {text::translatable("NeoETI report"),
          text::translatable(
              "This report needs JavaScript, which is switched off. Nothing is fetched from a network.")}) {
        replace_once(page, english, translate(english));
    }
    return page;
}

}  // namespace

ordered_json session_json(const session::SessionReader& reader, const Summary& summary) {
    const std::vector<session::StepRecord> steps = reader.steps();
    const AttemptMetrics first = first_values(steps);
    ordered_json out;
    out["file"] = summary.file.filename().string();
    put_session(out, summary);
    out["debriefing"] = shown_scenario(summary.info.scenario_text).debriefing;
    out["live"] = summary.live;
    out["run"] = record_json(summary.run, summary, first);
    out["attempts"] = ordered_json::array();
    for (const session::SummaryRecord& attempt : summary.attempts) {
        out["attempts"].push_back(record_json(attempt, summary, first));
    }
    out["practise"] = practise_json(summary, steps, first);
    out["moments"] = moments_json(steps);
    out["samples"] = samples_json(steps);
    out["events"] = ordered_json::array();
    for (const session::EventRecord& event : reader.events()) {
        out["events"].push_back({{"time_s", 1e-9 * static_cast<double>(event.time_ns)},
                                 {"kind", event.kind},
                                 {"text", text::translate_sentence(event.text)}});
    }
    out["ratings"] = ratings_json(summary.ratings);
    out["answers"] = answers_json(summary.answers);
    return out;
}

ordered_json fields_json() {
    ordered_json out = ordered_json::array();
    for (const MetricField& field : metric_fields) {
        out.push_back({{"key", field.key},
                       {"label", translate(field.label)},
                       {"unit", field.unit},
                       {"in_paper", field.in_paper},
                       {"definition", translate(field.definition)},
                       {"norm", translate(field.norm)}});
    }
    return out;
}

std::string escape_for_script(const ordered_json& json) {
    const std::string text = json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
    // JSON has `<` only inside strings, where an escape is equivalent.
    std::string out;
    out.reserve(text.size());
    for (const char c : text) {
        c == '<' ? out += "\\u003c" : out += c;
    }
    return out;
}

std::filesystem::path write_report(const std::vector<std::filesystem::path>& sessions,
                                   const std::filesystem::path& folder,
                                   const std::optional<ScoreModel>& model,
                                   const std::function<bool()>& stop) {
    constexpr std::string_view place = "<!--sessions-->";
    const std::string page = translated_page();
    const std::size_t cut = page.find(place);
    if (cut == std::string_view::npos) {
        throw ExportError(
            "report: this program was built without the page because npm or its packages were missing; "
            "install Debian's npm, configure with network access (cmake --preset release) and build "
            "eti-review again");
    }
    const std::filesystem::path path = folder / "report.html";
    refuse_existing(path, "--out");
    ordered_json data{
        {"program", ETI_VERSION}, {"fields", fields_json()}, {"sessions", ordered_json::array()}};
    for (const std::filesystem::path& file : sessions) {
        if (stop()) {
            return {};
        }
        const session::SessionReader reader(file);
        const Summary summary = summarise(file);
        ordered_json one = session_json(reader, summary);
        if (model) {
            one["score"] = summary.outcome_known(summary.run) ? score_json(*model, summary) : ordered_json();
        }
        one["anatomy"] = anatomy_json(reader);
        data["sessions"].push_back(std::move(one));
    }
    std::string whole = page.substr(0, cut);
    whole += escape_for_script(data);
    whole += page.substr(cut + place.size());
    write_new_file(path, whole, "--out");
    return path;
}

}  // namespace eti::review
