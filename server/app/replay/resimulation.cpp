// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/replay/resimulation.hpp"

#include <spdlog/spdlog.h>

#include <cmath>
#include <iostream>
#include <set>

#include "common/model/pace.hpp"
#include "common/model/thresholds.hpp"
#include "common/process/progress_bar.hpp"
#include "common/process/stop_signal.hpp"
#include "common/scenario/setting.hpp"
#include "server/app/output/recorder.hpp"
#include "server/app/output/recording.hpp"
#include "server/app/output/session_info.hpp"
#include "server/app/replay/step_comparison.hpp"
#include "server/app/run/assessment_thread.hpp"
#include "server/app/run/commands/command_handler.hpp"
#include "server/app/run/simulation.hpp"

namespace eti::app {

namespace {

using session::SummaryRecord;

constexpr int differs = 1, incomplete = 3, interrupted = 130;

bool same(const AttemptMetrics& a, const AttemptMetrics& b) {
    return std::ranges::all_of(metric_fields, [&](const MetricField& field) {
        const double x = a.*field.value, y = b.*field.value;
        return x == y || (std::isnan(x) && std::isnan(y));
    });
}

bool same(const std::vector<SummaryRecord>& a, const std::vector<SummaryRecord>& b) {
    return std::ranges::equal(a, b, [](const SummaryRecord& x, const SummaryRecord& y) {
        return x.attempt == y.attempt && x.outcome.success == y.outcome.success &&
               x.outcome.reason == y.outcome.reason && same(x.metrics, y.metrics);
    });
}

std::string shown(double value) {
    return std::isfinite(value) ? fmt::format("{:.6g}", value) : "-";
}

std::string comparison_table(const SummaryRecord& recorded, const SummaryRecord& simulated) {
    std::size_t width = 0;
    for (const MetricField& field : metric_fields) {
        width = std::max(width, field.label.size());
    }
    std::string out =
        fmt::format("  {:<{}}  {:<5}{:>12}{:>12}\n", "metric of the run", width, "", "recorded", "here");
    for (const MetricField& field : metric_fields) {
        const std::string then = shown(recorded.metrics.*field.value),
                          now = shown(simulated.metrics.*field.value);
        out += fmt::format("{} {:<{}}  {:<5}{:>12}{:>12}\n", then == now ? ' ' : '*', field.label, width,
                           field.unit, then, now);
    }
    return out;
}

class Resimulation {
  public:
    explicit Resimulation(const Options& options)
        : options_(options),
          recording_(read_recording(options.resimulate)),
          scenario_(scenario_of(options.resimulate, recording_.reader.info(), options.settings)),
          patient_(patient_of(scenario_)),
          inputs_(parked_inputs(scenario_, patient_)),
          command_handler_(limits_of(scenario_), inputs_.runtime_parameters),
          comparison_(std::max<std::size_t>(recording_.scene.tube_nodes, 1),
                      [this](const std::string& series, std::size_t row) {
                          return !set_series_.contains(series) && recording_.has_row(series, row);
                      }) {
        for (const std::string& typed : options.settings) {
            if (find_runtime_parameter_by_key(key_of(typed)) != nullptr) {
                const RuntimeParameterSetting setting = parse_runtime_parameter(typed);
                if (const std::string refusal =
                        command_handler_.apply({"--set", 0, std::string(setting.field->name), setting.value});
                    !refusal.empty()) {
                    throw InputError(fmt::format("--set {}: {}", typed, refusal));
                }
                held_.insert(std::string(setting.field->name));
                set_series_.insert(fmt::format("{}/{}", setting.field->group, setting.field->name));
            }
        }
        inputs_.runtime_parameters = command_handler_.wanted();
        simulation_ = std::make_unique<Simulation>(scenario_, patient_, inputs_);
        start();
        here_ = session_info(scenario_, patient_);
        if (!options.record.empty()) {
            record();
        }
        assessment_.emplace(simulation_->assessor(), recorder_ ? &*recorder_ : nullptr, nullptr, false);
        assessment_->set_observer([this](const session::StepRecord& step) {
            comparison_.compare(recording_.steps[row_], step, row_);
        });
    }

    int run() {
        ProgressBar progress;
        const std::size_t rows =
            std::min<std::size_t>(recording_.steps.size(), options_.steps.value_or(recording_.steps.size()));
        const std::string length = fmt::format("of {:.1f} s", static_cast<double>(rows) / steps_per_second);
        for (; row_ < rows && !stop_requested(); ++row_) {
            progress.draw(static_cast<float>(row_) / static_cast<float>(rows), length);
            if (!latch(recording_.steps[row_])) {
                break;
            }
            simulation_->scene().step(inputs_);
            assessment_->submit(simulation_->snapshot(), eye_);
            compare_state(row_ + 1 == rows);
        }
        progress.clear();
        assessment_->finish();
        const bool kept = !recorder_ || recorder_->finish();
        const int status = report();
        return stop_requested() ? interrupted : kept ? status : incomplete;
    }

  private:
    /// Places the tools at their poses before the first step, in the same way as the server for its operator.
    void start() {
        const RigidTransform& laryngoscope = recording_.scene.laryngoscope_start;
        const RigidTransform& grip = recording_.scene.tube_grip_start;
        if (!is_valid_pose(laryngoscope) || !is_valid_pose(grip)) {
            doubts_.push_back("the file lacks the poses of the tools before the first step");
            return;
        }
        if (!recording_.reader.info().operator_name.empty()) {
            inputs_.laryngoscope = laryngoscope;
            inputs_.tube_grip = grip;
            simulation_->scene().reset(inputs_);
        }
    }

    void record() {
        session::SessionInfo info = here_;
        const session::SessionInfo& recorded = recording_.reader.info();
        info.session = recorded.session;
        info.operator_name = recorded.operator_name;
        info.operator_text = recorded.operator_text;
        info.seed = recorded.seed;
        info.more["resimulation_of"] = options_.resimulate.filename().string();
        info.more["resimulation_set"] = fmt::format("{}", fmt::join(options_.settings, " "));
        recorder_.emplace(options_.record, std::move(info), patient_, simulation_->scope(), scenario_,
                          simulation_->snapshot(), true);
    }

    /// Latches the inputs recorded before a step; returns false if the file does not have them.
    bool latch(const session::StepRecord& step) {
        if (step.step != simulation_->snapshot().step + 1) {
            ended_ = fmt::format("after step {} the file continues with step {}",
                                 simulation_->snapshot().step, step.step);
            return false;
        }
        if (!is_valid_pose(step.laryngoscope) || !is_valid_pose(step.tube_grip)) {
            ended_ = fmt::format("at step {} the file lacks the pose of a tool", step.step);
            return false;
        }
        inputs_.laryngoscope = step.laryngoscope;
        inputs_.tube_grip = step.tube_grip;
        eye_ = is_valid_pose(step.eye) ? std::optional(step.eye) : std::nullopt;
        take_events(step.time_ns);
        take_commands(step.step);
        inputs_.runtime_parameters = command_handler_.wanted();
        // Its effective value, including the hand's button: suction follows its target without lag.
        if (!held_.contains("suction") && std::isfinite(step.runtime_parameters.suction)) {
            inputs_.runtime_parameters.suction = step.runtime_parameters.suction;
        }
        if (command_handler_.take_reset()) {
            simulation_->scene().reset(inputs_);
        }
        return true;
    }

    /// Every second and after the last step.
    void compare_state(bool last) {
        const scene::Snapshot& s = simulation_->snapshot();
        if (s.step % steps_per_second != 0 && !last) {
            return;
        }
        const std::string hash = state_hash();
        assessment_->log(session::StateRecord{s.time_ns, s.step, hash});
        const auto recorded = std::ranges::find(recording_.states, s.step, &session::StateRecord::step);
        if (recorded != recording_.states.end()) {
            ++states_;
            equal_states_ += recorded->hash == hash ? 1 : 0;
        }
    }

    [[nodiscard]] std::string state_hash() const {
        return fmt::format("{:016x}", simulation_->scene().state_hash());
    }

    void take_events(std::uint64_t before_ns) {
        for (; next_event_ < recording_.events.size() && recording_.events[next_event_].time_ns < before_ns;
             ++next_event_) {
            const session::EventRecord& event = recording_.events[next_event_];
            if (event.kind == session::device_event) {
                if (event.text.starts_with("laryngoscope ") && !std::exchange(laryngoscope_here_, true)) {
                    simulation_->scene().place_laryngoscope(inputs_.laryngoscope);
                } else if (event.text.starts_with("tube ") && !std::exchange(tube_here_, true)) {
                    simulation_->scene().place_tube(inputs_.tube_grip);
                }
            }
            if (event.kind != "attempt") {  // those are assessed again
                assessment_->log(event);
            }
        }
        for (; next_annotation_ < recording_.annotations.size() &&
               recording_.annotations[next_annotation_].time_ns < before_ns;
             ++next_annotation_) {
            assessment_->log(recording_.annotations[next_annotation_]);
        }
    }

    void take_commands(std::uint64_t step) {
        for (; next_command_ < recording_.commands.size() && recording_.commands[next_command_].step <= step;
             ++next_command_) {
            const session::CommandRecord& command = recording_.commands[next_command_];
            if (held_.contains(command.kind) || command.kind == "stop" || command.kind == "next") {
                continue;
            }
            if (const std::string refusal = command_handler_.apply(
                    {command.sender, command.id, command.kind, static_cast<float>(command.value)});
                !refusal.empty()) {
                spdlog::warn("step {}: the recorded command {} is rejected here: {}", step, command.kind,
                             refusal);
            }
            assessment_->log(command);
        }
    }

    [[nodiscard]] bool what_if() const { return !options_.settings.empty(); }

    /// Possible reasons for a difference in a step.
    [[nodiscard]] std::vector<std::string> reasons() const {
        std::vector<std::string> out = differences(recording_.reader.info(), here_);
        if (const std::uint64_t version = recording_.scene.definitions.version;
            version != 0 && version != definitions_version) {
            out.push_back(
                fmt::format("different definitions of the metrics: version {} in the recording, {} here",
                            version, definitions_version));
        }
        if (what_if()) {
            out.insert(out.begin(), fmt::format("set here: {}", fmt::join(options_.settings, ", ")));
        }
        out.insert(out.end(), doubts_.begin(), doubts_.end());
        if (const std::uint64_t lost = recording_.reader.lost_records(); lost > 0) {
            out.push_back(fmt::format("{} records were lost while recording: the disk was too slow", lost));
        }
        if (out.empty()) {
            out.push_back(
                "version, build, processor, libraries, physics and patient are the same: the file was "
                "changed after the recording, or the simulation depends on something else");
        }
        return out;
    }

    int report() const {
        const std::vector<SummaryRecord> simulated = summaries_of(simulation_->metrics());
        std::vector<SummaryRecord> recorded = recording_.summaries;
        const bool whole = row_ == recording_.steps.size();
        const bool has_run_summary = recording_.has_run_summary();
        if (!has_run_summary) {
            // Without a summary of the run: the values of the last step.
            recorded.insert(recorded.begin(), {0,
                                               {false, "the recording ends before the results were computed"},
                                               recording_.steps[std::max<std::size_t>(row_, 1) - 1].metrics});
        }
        const bool steps_equal =
            row_ > 0 && comparison_.equal() == comparison_.steps() && equal_states_ == states_;
        const bool equal = steps_equal && (!whole || !has_run_summary || same(recorded, simulated));
        if (options_.json) {
            print_json(equal, has_run_summary, recorded, simulated);
        } else {
            print(equal, recorded, simulated);
        }
        return equal || what_if() ? 0 : differs;
    }

    void print_json(bool equal, bool has_run_summary, const std::vector<SummaryRecord>& recorded,
                    const std::vector<SummaryRecord>& simulated) const {
        nlohmann::ordered_json out{{"file", options_.resimulate.string()},
                                   {"settings", options_.settings},
                                   {"equal", equal},
                                   {"steps", comparison_.steps()},
                                   {"recorded_steps", recording_.steps.size()},
                                   {"equal_steps", comparison_.equal()},
                                   {"states", states_},
                                   {"equal_states", equal_states_},
                                   {"ended_early", ended_}};
        out["first_difference"] = nullptr;
        if (const auto& first = comparison_.first()) {
            out["first_difference"] = {{"step", first->step},
                                       {"time_s", first->time},
                                       {"series", first->series},
                                       {"recorded", first->recorded},
                                       {"simulated", first->simulated}};
        }
        out["reasons"] = equal ? std::vector<std::string>{} : reasons();
        out["recorded"] = result_json(recorded);
        if (!has_run_summary) {
            out["recorded"]["success"] = nullptr;
        }
        out["simulated"] = result_json(simulated);
        out["state_hash"] = state_hash();
        std::cout << out.dump(2) << std::endl;
    }

    void print(bool equal, const std::vector<SummaryRecord>& recorded,
               const std::vector<SummaryRecord>& simulated) const {
        std::string out = fmt::format(
            "{}: {} of {} steps simulated again, {} identical to the recording\n",
            options_.resimulate.string(), comparison_.steps(), recording_.steps.size(),
            comparison_.equal() == comparison_.steps() ? "all" : std::to_string(comparison_.equal()));
        if (!ended_.empty()) {
            out += fmt::format("ended early: {}\n", ended_);
        }
        if (!recording_.reader.finished()) {
            out += "the recording was cut off before its end\n";
        }
        if (const auto& first = comparison_.first()) {
            out += fmt::format(
                "first difference: step {} ({:.3f} s), {}: {:.9g} in the recording, {:.9g} here\n",
                first->step, first->time, first->series, first->recorded, first->simulated);
        } else if (equal_states_ != states_) {
            out += "the recorded series are identical, but the hashes of the state differ\n";
        } else if (!equal) {
            out += "the steps are identical, but the results differ\n";
        }
        if (!equal) {
            for (const std::string& reason : reasons()) {
                out += fmt::format("  {}\n", reason);
            }
        }
        out += fmt::format("recorded: {}\nhere:     {}\n", recorded.front().outcome.reason,
                           simulated.front().outcome.reason);
        if (!equal) {
            out += comparison_table(recorded.front(), simulated.front());
        }
        std::cout << out << std::flush;
    }

    const Options& options_;
    Recording recording_;
    Scenario scenario_;
    patient::Patient patient_;
    scene::Inputs inputs_;
    CommandHandler command_handler_;
    StepComparison comparison_;
    std::set<std::string> held_;        // runtime parameters that are overridden throughout
    std::set<std::string> set_series_;  // their series, which may differ from the recording
    std::unique_ptr<Simulation> simulation_;
    session::SessionInfo here_;
    std::optional<Recorder> recorder_;
    std::optional<AssessmentThread> assessment_;
    std::optional<RigidTransform> eye_;
    std::size_t row_ = 0;
    std::size_t states_ = 0, equal_states_ = 0;  // compared hashes
    std::size_t next_event_ = 0, next_annotation_ = 0, next_command_ = 0;
    bool laryngoscope_here_ = false, tube_here_ = false;
    std::string ended_;                // why it ended before the file's end; empty if it did not
    std::vector<std::string> doubts_;  // what the file lacks
};

}  // namespace

int resimulate(const Options& options) {
    Resimulation resimulation(options);
    return resimulation.run();
}

}  // namespace eti::app
