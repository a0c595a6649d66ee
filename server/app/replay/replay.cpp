// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/replay/replay.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <thread>

#include "common/bus/codec/annotation.hpp"
#include "common/model/pace.hpp"
#include "common/process/stop_signal.hpp"
#include "common/process/terminal.hpp"
#include "server/app/output/bus_output.hpp"
#include "server/app/output/haptic_publisher.hpp"
#include "server/app/replay/recorded_states.hpp"
#include "server/app/run/bus_input.hpp"
#include "server/app/run/commands/annotation_board.hpp"

namespace eti::app {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int states_per_second = 90;
constexpr std::uint64_t steps_per_look = steps_per_second / 30;
constexpr int states_per_repeat = 9;  // repeats the state for late joiners while nothing changes
constexpr double rows_per_state = static_cast<double>(steps_per_second) / states_per_second;
constexpr double jump = 1.0;  // [s], per arrow key
constexpr double slowest = 1.0 / 16, fastest = 16.0;
// A jump back of this length makes a client restart (client/view). It would drop states of a shorter one as
// late.
constexpr std::uint64_t restart_ns = 1'000'000'000;
constexpr std::chrono::milliseconds restart_pause{60};

constexpr const char* keys =
    "space pauses, arrows go 1 s, < and > a state, [ and ] change the speed, "
    "0 begins again, q ends";

/// The scenario, as far as this version can read it: drawing depends on few of its values.
Scenario scenario_in(const Recording& recording, const std::filesystem::path& file) {
    const session::SessionInfo& info = recording.reader.info();
    Scenario scenario;
    try {
        scenario = parse_scenario(info.scenario_text, fmt::format("the scenario in {}", file.string()));
    } catch (const InputError& error) {
        spdlog::warn("{}; shown without it", error.what());
        scenario.text = info.scenario_text;
        scenario.tube.outer_diameter = recording.scene.tube_outer_diameter;
        scenario.tube.inner_diameter = recording.scene.tube_inner_diameter;
    }
    scenario.name = info.scenario;
    scenario.saliva = recording.reader.root().has("fluid");
    for (const Blade blade : {Blade::miller_0, Blade::miller_1}) {
        if (name_of(blade) == recording.scene.blade) {
            scenario.blade = blade;
        }
    }
    return scenario;
}

/// Result of an attempt, and when it was available.
struct AttemptEnd {
    std::uint64_t time_ns = 0;
    const session::SummaryRecord* summary = nullptr;
};

std::vector<AttemptEnd> attempt_ends(const Recording& recording) {
    const auto& steps = recording.steps;
    // That of the run is available with the last published state.
    const std::size_t last = steps.size() - (steps.size() > 1 && steps.back().step % 2 != 0 ? 2 : 1);
    std::vector<AttemptEnd> out;
    for (const session::SummaryRecord& summary : recording.summaries) {
        std::uint64_t end = steps[last].time_ns;
        for (const session::StepRecord& step : steps) {
            if (summary.attempt != 0 && step.attempt == summary.attempt && !step.attempt_running) {
                end = step.time_ns;
                break;
            }
        }
        out.push_back({end, &summary});
    }
    std::ranges::stable_sort(out, {}, &AttemptEnd::time_ns);
    return out;
}

/// The message as originally sent.
msg::Annotation message_of(const session::AnnotationRecord& record) {
    return bus::encode_annotation({record.time_ns,
                                   record.kind == "point" ? msg::ANNOTATION_POINT : msg::ANNOTATION_STROKE,
                                   record.sender, record.text, record.object, record.place});
}

class Replay {
  public:
    explicit Replay(const Options& options)
        : options_(options),
          recording_(read_recording(options.replay.file)),
          scenario_(scenario_in(recording_, options.replay.file)),
          states_(recording_, scenario_),
          scope_(make_laryngoscope(scenario_.blade)),
          ends_(attempt_ends(recording_)),
          first_(row_at(options.replay.from)),
          last_(options.replay.to ? row_at(*options.replay.to) : states_.size() - 1),
          position_(static_cast<double>(first_)),
          speed_(options.replay.speed),
          paused_(options.replay.pause) {
        if (first_ >= last_) {
            throw InputError(
                fmt::format("{}: nothing is recorded from {:.3f} to {:.3f} s; it goes from {:.3f} "
                            "to {:.3f} s",
                            options.replay.file.string(), options.replay.from,
                            options.replay.to.value_or(time_at(states_.size() - 1)), time_at(0),
                            time_at(states_.size() - 1)));
        }
        node_.emplace(options.bus);
        for (const std::string& warning :
             bus::self_check(*node_, true, std::chrono::milliseconds(600)).warnings) {
            spdlog::warn("{}", warning);
        }
        input_.emplace(*node_);
        haptic_publisher_.emplace(*node_);
        output_.emplace(*node_, scenario_, states_.patient(), scope_,
                        recording_.steps.front().runtime_parameters);
        begin();
    }

    int run() {
        spdlog::info("session '{}' replays {}: {:.1f} s of scenario '{}'{}", options_.bus.session,
                     options_.replay.file.string(), time_at(states_.size() - 1), scenario_.name,
                     recording_.reader.finished() ? "" : ", cut off before its end");
        if (terminal_.there()) {
            spdlog::info("{}", keys);
        }
        auto next = Clock::now();
        while (!ended_ && !stop_requested()) {
            take_commands();
            handle_keys();
            const std::size_t before = row_;
            row_ = row_of(position_);
            if (row_ != before || tick_ % states_per_repeat == 0) {
                publish_state();
            }
            print_position();
            advance();
            ++tick_;
            next = std::max(next + std::chrono::nanoseconds(1'000'000'000 / states_per_second),
                            Clock::now() - std::chrono::milliseconds(100));
            std::this_thread::sleep_until(next);
        }
        if (on_terminal_) {
            std::cerr << "\r\033[K" << std::flush;
        }
        haptic_publisher_->finish();
        output_->finish(status());
        spdlog::info("the replay ended at {:.1f} s", time_at(row_));
        return 0;
    }

  private:
    [[nodiscard]] double time_at(std::size_t row) const {
        return 1e-9 * static_cast<double>(recording_.steps[row].time_ns);
    }
    /// The last row at or before a time [s]; the first row for earlier times.
    [[nodiscard]] std::size_t row_at(double seconds) const {
        const auto& steps = recording_.steps;
        const auto after = std::ranges::upper_bound(steps, seconds, {}, [](const session::StepRecord& s) {
            return 1e-9 * static_cast<double>(s.time_ns);
        });
        return after == steps.begin() ? 0 : static_cast<std::size_t>(after - steps.begin()) - 1;
    }
    /// The published step at or before a position.
    [[nodiscard]] std::size_t row_of(double position) const {
        const auto row = static_cast<std::size_t>(position);
        return row > first_ && recording_.steps[row].step % 2 != 0 ? row - 1 : row;
    }

    [[nodiscard]] StatusValues status() const {
        return {paused_ ? msg::PHASE_FROZEN : msg::PHASE_RUNNING, 0.0f, 0.0f, msg::DEVICE_NONE,
                msg::DEVICE_NONE};
    }

    /// Restarts the publication of results, notes and marks.
    void begin() {
        board_.emplace(states_.patient(), laryngoscope_mesh(scope_));
        told_ends_ = told_marks_ = told_events_ = 0;
        next_look_ = 0;
        row_ = row_of(position_);
        publish_state();
    }

    void publish_state() {
        const scene::Snapshot& s = states_.at(row_);
        // A haptic device connected to a replay must not render forces that another user felt.
        haptic_publisher_->post_visible_proxy(s);
        output_->post(s, status());
        // By due step, as the shapes for slow readers are sent: both then are of the same step.
        if (paused_ || s.step >= next_look_) {
            next_look_ = (s.step / steps_per_look + 1) * steps_per_look;
            output_->post_live(s, states_.status(row_));
            output_->post_status(status());
        }
        publish_events(s);
    }

    /// Publishes results, notes and marks up to now.
    void publish_events(const scene::Snapshot& now) {
        for (; told_ends_ < ends_.size() && ends_[told_ends_].time_ns <= now.time_ns; ++told_ends_) {
            const session::SummaryRecord& end = *ends_[told_ends_].summary;
            output_->post_summary(end.attempt, end.outcome, end.metrics);
        }
        for (; told_events_ < recording_.events.size() &&
               recording_.events[told_events_].time_ns <= now.time_ns;
             ++told_events_) {
            const session::EventRecord& event = recording_.events[told_events_];
            const bool wiped = event.kind == session::annotation_event &&
                               event.text.ends_with(AnnotationBoard::clear_suffix);
            if (event.kind == session::note_event || wiped) {
                publish_marks(now, event.time_ns);
                msg::Annotation message;
                const std::size_t colon = event.text.find(": ");
                message.sender(event.text.substr(0, std::min(colon, msg::bound::Annotation_sender)));
                message.kind(wiped ? msg::ANNOTATION_CLEAR : msg::ANNOTATION_NOTE);
                message.text(colon == std::string::npos ? "" : event.text.substr(colon + 2));
                show_annotation(message, now, event.time_ns);
            }
        }
        publish_marks(now, now.time_ns);
    }

    void publish_marks(const scene::Snapshot& now, std::uint64_t until_ns) {
        for (; told_marks_ < recording_.annotations.size() &&
               recording_.annotations[told_marks_].time_ns <= until_ns;
             ++told_marks_) {
            const session::AnnotationRecord& mark = recording_.annotations[told_marks_];
            show_annotation(message_of(mark), now, mark.time_ns);
        }
    }

    void show_annotation(const msg::Annotation& message, const scene::Snapshot& now, std::uint64_t time_ns) {
        AnnotationBoard::HandledAnnotation taken = board_->handle(message, now);
        for (msg::ShownAnnotation& shown : taken.shown) {
            shown.header().simulation_time_ns(time_ns);
        }
        output_->post_shown(taken.shown);
    }

    void advance() {
        if (paused_) {
            return;
        }
        position_ += rows_per_state * speed_;
        if (position_ < static_cast<double>(last_) + 0.5) {
            return;
        }
        if (options_.loop) {
            seek(static_cast<double>(first_));
            return;
        }
        position_ = static_cast<double>(last_);
        if (row_ == row_of(position_)) {
            ended_ = true;
        }
    }

    /// `position`: a row within the shown range.
    void seek(double position) {
        position_ = std::clamp(position, static_cast<double>(first_), static_cast<double>(last_));
        const std::size_t to = row_of(position_);
        if (to >= row_) {
            return;
        }
        const std::uint64_t back = recording_.steps[row_].time_ns - recording_.steps[to].time_ns;
        if (back <= restart_ns) {
            scene::Snapshot beginning = states_.at(to);
            beginning.step = beginning.time_ns = 0;
            output_->post(beginning, status());
            std::this_thread::sleep_for(restart_pause);
        }
        begin();
    }
    void seek_by(double rows) { seek(position_ + rows); }

    void pause(bool wanted) { paused_ = wanted; }

    void take_commands() {
        input_->poll();
        for (const ReceivedCommand& command : input_->take_replaced()) {
            answer(command, "");
        }
        for (const ReceivedCommand& command : input_->take_commands()) {
            answer(command, execute(command));
        }
        for (const msg::Annotation& annotation : input_->take_annotations()) {
            const scene::Snapshot& now = states_.at(row_);
            show_annotation(annotation, now, now.time_ns);
        }
    }

    void answer(const ReceivedCommand& command, const std::string& refusal) {
        msg::CommandResult result;
        result.recipient(command.sender);
        result.id(command.id);
        result.accepted(refusal.empty());
        result.reason(refusal);
        output_->post_result(result);
    }

    /// Reason for rejection, or an empty string.
    std::string execute(const ReceivedCommand& command) {
        if (command.name == "start" || command.name == "pause") {
            pause(command.name == "pause");
        } else if (command.name == "stop") {
            ended_ = true;
        } else if (command.name == "reset") {
            seek(static_cast<double>(first_));
        } else if (command.name == "seek" && std::isfinite(command.value)) {
            seek(static_cast<double>(row_at(static_cast<double>(command.value))));
        } else {
            return "this is the replay of a recorded session: it accepts start, pause, seek, reset and stop";
        }
        return {};
    }

    void handle_keys() {
        while (const auto key = terminal_.key(std::chrono::milliseconds(0))) {
            switch (*key) {
                case ' ':
                    pause(!paused_);
                    break;
                case 'L':
                    seek_by(-jump * steps_per_second);
                    break;
                case 'R':
                    seek_by(jump * steps_per_second);
                    break;
                case '<':
                case ',':
                    pause(true);
                    seek_by(-rows_per_state);
                    break;
                case '>':
                case '.':
                    pause(true);
                    seek_by(rows_per_state);
                    break;
                case '[':
                    speed_ = std::max(slowest, 0.5 * speed_);
                    break;
                case ']':
                    speed_ = std::min(fastest, 2.0 * speed_);
                    break;
                case '0':
                    seek(static_cast<double>(first_));
                    break;
                case 'q':
                    ended_ = true;
                    break;
                case '\0':  // the terminal was closed
                    return;
                default:
                    break;
            }
        }
    }

    void print_position() const {
        if (on_terminal_ && tick_ % states_per_repeat == 0) {
            const double share =
                static_cast<double>(row_ - std::min(first_, row_)) / static_cast<double>(last_ - first_);
            std::cerr << fmt::format("\r\033[K[{:<30}] {:.2f} of {:.1f} s, {:g} x speed{}",
                                     std::string(static_cast<std::size_t>(30.0 * std::min(share, 1.0)), '='),
                                     time_at(row_), time_at(last_), speed_, paused_ ? ", paused" : "")
                      << std::flush;
        }
    }

    const Options& options_;
    Recording recording_;
    Scenario scenario_;
    RecordedStates states_;
    Laryngoscope scope_;
    std::vector<AttemptEnd> ends_;
    std::size_t first_, last_;  // rows
    double position_;           // row plus the fraction to the next
    double speed_;
    bool paused_;
    bool ended_ = false;
    std::size_t row_ = 0;  // row being shown
    std::uint64_t tick_ = 0;
    std::uint64_t next_look_ = 0;  // step from which measures are due again
    std::size_t told_ends_ = 0, told_marks_ = 0, told_events_ = 0;
    std::optional<bus::Node> node_;
    std::optional<BusInput> input_;
    std::optional<HapticPublisher> haptic_publisher_;
    std::optional<BusOutput> output_;
    std::optional<AnnotationBoard> board_;
    Terminal terminal_;
    bool on_terminal_ = ::isatty(STDERR_FILENO) != 0;
};

}  // namespace

int replay(const Options& options) {
    Replay running(options);
    return running.run();
}

}  // namespace eti::app
