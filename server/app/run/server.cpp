// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/server.hpp"

#include <spdlog/spdlog.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <utility>

#include "common/bus/bus.hpp"
#include "common/math/units.hpp"
#include "common/model/pace.hpp"
#include "common/operator/operator.hpp"
#include "common/process/service_notify.hpp"
#include "common/process/stop_signal.hpp"
#include "common/process/threads/priority.hpp"
#include "common/process/threads/processors.hpp"
#include "common/scenario/scenario.hpp"
#include "server/app/output/bus_output.hpp"
#include "server/app/output/haptic_publisher.hpp"
#include "server/app/output/lab_output.hpp"
#include "server/app/output/recorder.hpp"
#include "server/app/output/session_info.hpp"
#include "server/app/replay/replay.hpp"
#include "server/app/replay/resimulation.hpp"
#include "server/app/run/assessment_thread.hpp"
#include "server/app/run/bus_input.hpp"
#include "server/app/run/clock.hpp"
#include "server/app/run/commands/annotation_board.hpp"
#include "server/app/run/commands/command_handler.hpp"
#include "server/app/run/force_limit_monitor.hpp"
#include "server/app/run/local_operator.hpp"
#include "server/app/run/quality.hpp"
#include "server/app/run/saliva_monitor.hpp"
#include "server/app/run/simulation.hpp"
#include "server/app/run/solver_threads.hpp"
#include "server/app/run/step_priority.hpp"

namespace eti::app {

namespace {

constexpr double linger_after_attempt = 2.0;   // [s]
constexpr double linger_after_operator = 0.5;  // [s]
// The kernel reserves a twentieth of each second for ordinary threads. This is larger, because the solver's
// threads spin for work a while before they sleep.
constexpr double min_idle_share = 0.15;  // of a step

// Haptic devices have faded their force out by then (0.3 s); a proxy that is only seen would end it at once.
constexpr std::uint64_t steps_until_silent = steps_per_second / 2;

// Chosen: a person does not notice 2 % less than real time.
constexpr double behind_share = 0.02;

/// A tool's device, as last reported.
struct DeviceState {
    const char* name;
    msg::DevicePresence presence = msg::DEVICE_NONE;
    bool appeared = false;  // connected since the last step, for the first time
};

/// A manikin has no view evaluation, so that a stage that waits for the view ends by its timeout only.
void warn_about_view_stages(const OperatorScript& script) {
    for (const Track* track : {&script.laryngoscope, &script.tube}) {
        for (const Stage& stage : track->stages) {
            if (stage.until_view_percent > 0.0f && stage.timeout > 0.0f) {
                spdlog::warn(
                    "operator '{}', stage '{}': waits until {:g} % of the glottis are visible, but a manikin "
                    "has no view; it ends after {:g} s{}. Remedy: use an operator without view_percent",
                    script.name, stage.name, stage.until_view_percent, stage.timeout,
                    stage.abort_on_timeout ? ", and the rest is skipped" : "");
            }
        }
    }
}

class Session {
  public:
    /// `has_next_session`: another session follows this one. `threads` outlives it.
    Session(const Options& options, const Scenario& scenario, bool has_next_session, SolverThreads& threads)
        : options_(options),
          scenario_(scenario),
          threads_(threads),
          live_(options.with_bus && !options.fast) {
        if (!options.operator_name.empty()) {
            script_ = load_operator(find_data_file(options.operator_name, "operators"));
            script_->skill = options.skill.value_or(script_->skill);
            script_->attempts = options.attempts.value_or(script_->attempts);
            if (scenario.manikin) {
                warn_about_view_stages(*script_);
            }
        }
        if (options.with_bus) {
            const RealTimeThreads real_time(priority::bus, live_);
            priority_refusal_ = real_time.refusal();
            bus_.emplace(options.bus);
            for (const std::string& warning :
                 bus::self_check(*bus_, true, std::chrono::milliseconds(600)).warnings) {
                spdlog::warn("{}", warning);
            }
        }
        patient_ = patient_of(scenario_);
        choose_quality();
        inputs_ = parked_inputs(scenario_, patient_);
        simulation_ = std::make_unique<Simulation>(scenario_, patient_, inputs_);
        command_handler_ = CommandHandler(limits_of(scenario_), inputs_.runtime_parameters, has_next_session);
        if (script_) {
            start_operator();
            simulation_->scene().reset(inputs_);
        }
        if (!options.record.empty()) {
            session::SessionInfo info = session_info(scenario_, patient_);
            info.session = options.bus.session;
            info.operator_name = script_ ? script_->name : "";
            info.operator_text =
                script_ ? read_text_file(find_data_file(options.operator_name, "operators")) : "";
            info.seed = options.seed.value_or(scenario_.seed);
            info.more[session::participant_text] = options.participant;
            info.more[session::quality_text] = name_of(quality_);
            if (script_) {
                info.more[session::skill_text] = fmt::format("{:g}", script_->skill);
            }
            recorder_.emplace(options.record, std::move(info), patient_, simulation_->scope(), scenario_,
                              simulation_->snapshot(), options.fast);
            spdlog::info("recording to {}", options.record.string());
        }
        start_threads();
    }

    /// Whether all sessions were asked to end, not only this one.
    [[nodiscard]] bool all_ended() const { return stop_requested() || command_handler_.stopped(); }

    /// Whether it followed the clock and could not keep up with it.
    [[nodiscard]] bool fell_behind() const { return behind_ > behind_share * simulation_->time(); }

    int run() {
        spdlog::info("session '{}' runs scenario '{}': {} particles, {} clusters, {} substeps",
                     options_.bus.session, scenario_.name, patient_.particles.size(),
                     patient_.clusters.size(), scenario_.physics.substeps);
        if (!priority_refusal_.empty()) {
            spdlog::warn("{}", priority_refusal_);
        }
        const bool real_time = live_ && priority_refusal_.empty();
        StepClock clock(step_duration, !options_.fast, real_time ? min_idle_share : 0.0);
        {
            StepPriority priority(live_);
            while (!ended()) {
                service_.alive();
                if (frozen()) {
                    pause(clock);
                    continue;
                }
                const std::uint32_t late_before = clock.late_steps();
                clock.wait();
                latch(clock);
                set_tools();
                step(clock);
                clock.done();
                priority.update(clock.late_steps() > late_before);
                report_progress(clock);
            }
        }
        service_.ending();
        if (input_) {  // a note that was acknowledged must not be lost
            input_->poll();
            take_annotations();
        }
        log_state();
        behind_ = clock.behind();
        assessment_->finish();
        const bool kept = !recorder_ || recorder_->finish();
        lab_.reset();
        if (output_) {
            haptic_publisher_->finish();
            output_->finish(status(clock));
            if (const std::uint64_t skipped = haptic_publisher_->skipped() + output_->skipped();
                skipped > 0) {
                spdlog::info("{} states were superseded before they were sent", skipped);
            }
        }
        if (input_ && input_->refused() > 0) {
            spdlog::warn("{} poses were rejected: not finite, or more than two metres from the patient",
                         input_->refused());
        }
        report(clock);
        return kept ? 0 : 3;
    }

  private:
    /// Measures this machine where nobody has chosen, and reduces the scenario where it is too slow.
    void choose_quality() {
        quality_ = options_.quality;
        if (quality_ == Quality::automatic) {
            quality_ = live_ && !scenario_.manikin ? finest_in_real_time(scenario_, patient_) : Quality::full;
        }
        if (quality_ == Quality::reduced) {
            scenario_ = reduced(scenario_);
        }
    }

    void start_threads() {
        if (bus_) {
            input_.emplace(*bus_);
            board_.emplace(patient_, laryngoscope_mesh(simulation_->scope()));
            {
                const RealTimeThreads real_time(priority::bus, live_);
                haptic_publisher_.emplace(*bus_);
            }
            // At normal priority the thread could be preempted while it holds the bus's locks, which would
            // delay haptics.
            const RealTimeThreads real_time(priority::step, live_);
            output_.emplace(*bus_, scenario_, patient_, simulation_->scope(), inputs_.runtime_parameters);
            lab_.emplace(*bus_, patient_, live_);
            proxy_moved_ = [this](const scene::ProxySnapshot& proxy) {
                haptic_publisher_->post_proxy(proxy);
            };
        }
        const RealTimeThreads real_time(priority::background, live_);
        // An operator in this process needs the view before each step; all others only receive results.
        const bool beside = !operator_;
        assessment_.emplace(simulation_->assessor(), recorder_ ? &*recorder_ : nullptr,
                            output_ ? &*output_ : nullptr, beside);
    }

    /// Creates the operator, before the first stage of its script.
    void start_operator() {
        const std::uint64_t seed = options_.seed.value_or(scenario_.seed ^ script_->seed);
        pass_began_ = simulation_->time();
        pass_first_step_ = simulation_->snapshot().step;
        operator_.emplace(*script_, simulation_->scope(), scenario_.tube, seed, operator_view());
        operator_->apply_to(inputs_);
    }

    /// The operator's observation, with time since the script began.
    [[nodiscard]] Observation operator_view() const {
        Observation seen = simulation_->observation();
        seen.time -= pass_began_;
        return seen;
    }

    /// Restarts the operator's script, as after the command that is recorded for it.
    void restart_operator(const StepClock& clock) {
        const scene::Snapshot& s = simulation_->snapshot();
        const std::size_t steps = s.step - pass_first_step_;
        const metrics::AttemptSummary run = simulation_->metrics().run();
        // tests/bench/server/soak.py reads this line.
        spdlog::info(
            "pass {} ended at {:.1f} s after {} steps of {:.3f} ms, 99 % within {:.3f} ms; state {}; "
            "{} attempts",
            ++passes_, simulation_->time(), steps, 1e3 * clock.percentile(0.5, steps),
            1e3 * clock.percentile(0.99, steps), state_hash(), run.metrics.attempts);
        operator_done_at_ = -1.0;
        if (recorder_) {
            assessment_->log(session::CommandRecord{s.time_ns, s.step + 1, "reset", 0.0, "operator", 0});
        }
        // The script assumes a patient at rest around the tools as it then holds them.
        simulation_->scene().reset(inputs_);
        start_operator();
        reset_ = true;
    }

    void latch(const StepClock& clock) {
        if (operator_ && operator_done()) {
            restart_operator(clock);
        } else if (operator_) {
            operator_->advance(operator_view(), simulation_->snapshot());
            operator_->apply_to(inputs_);
        }
        if (!input_) {
            return;
        }
        input_->poll();
        if (!operator_) {
            follow_devices();
        }
        take_commands();
        take_annotations();
        // The larger of the hand's button and the command.
        inputs_.runtime_parameters = command_handler_.wanted();
        if (!operator_ && input_->suction()) {
            inputs_.runtime_parameters.suction = 1.0f;
        }
    }

    /// Applies changes of the tools that take effect at once. Called right before a step, so that the inputs
    /// recorded with the step include their placement, also after a pause.
    void set_tools() {
        if (laryngoscope_.appeared) {
            simulation_->scene().place_laryngoscope(inputs_.laryngoscope);
        }
        if (tube_.appeared) {
            simulation_->scene().place_tube(inputs_.tube_grip);
        }
        laryngoscope_.appeared = tube_.appeared = false;
        if (command_handler_.take_reset() || std::exchange(reset_, false)) {
            simulation_->scene().reset(inputs_);
        }
    }

    void take_annotations() {
        for (const msg::Annotation& annotation : input_->take_annotations()) {
            AnnotationBoard::HandledAnnotation taken = board_->handle(annotation, simulation_->snapshot());
            if (!taken.refusal.empty()) {
                if (const auto suppressed = annotations_refused_.allow("annotation")) {
                    spdlog::warn("a mark of '{}' was rejected: {}{}", annotation.sender().to_string(),
                                 taken.refusal, suppressed_suffix(*suppressed));
                }
                continue;
            }
            spdlog::info("{} {}",
                         taken.event.kind == session::note_event ? "note of" : "marks:", taken.event.text);
            assessment_->log(std::move(taken.event));
            if (taken.places) {
                assessment_->log(std::move(*taken.places));
            }
            output_->post_shown(taken.shown);
        }
    }

    void follow_devices() {
        const auto follow = [this](const FollowedDevice& device, DeviceState& state, RigidTransform& input) {
            if (device.pose()) {
                state.appeared = state.appeared || state.presence == msg::DEVICE_NONE;
                input = *device.pose();
            }
            if (device.presence() != state.presence) {
                report_presence(state, device.presence());
            }
        };
        follow(input_->laryngoscope(), laryngoscope_, inputs_.laryngoscope);
        follow(input_->tube(), tube_, inputs_.tube_grip);
    }

    void report_presence(DeviceState& state, msg::DevicePresence now) {
        const bool back = state.presence == msg::DEVICE_SILENT;
        state.presence = now;
        if (now == msg::DEVICE_SILENT) {
            spdlog::warn("the {}'s device has been silent for {} ms; {}", state.name,
                         FollowedDevice::silence_timeout.count(),
                         scenario_.freeze_on_silence ? "simulation paused until it is back"
                                                     : "the tool stays where it was");
        } else {
            spdlog::info("the {}'s device is {}", state.name, back ? "back" : "here");
        }
        const char* const what = now == msg::DEVICE_SILENT ? "silent" : back ? "back" : "here";
        assessment_->log(session::EventRecord{simulation_->snapshot().time_ns,
                                              std::string(session::device_event),
                                              fmt::format("{} {}", state.name, what)});
    }

    /// Time stands still only at a step whose measures are published, so that shape and measures of the
    /// standing moment agree.
    [[nodiscard]] bool frozen() const {
        return scenario_.freeze_on_silence && simulation_->snapshot().step % steps_per_view_check == 0 &&
               (laryngoscope_.presence == msg::DEVICE_SILENT || tube_.presence == msg::DEVICE_SILENT);
    }

    void take_commands() {
        for (const ReceivedCommand& command : input_->take_replaced()) {
            command_handler_.discard(command);
            output_->post_result(command_handler_.answer());
        }
        for (const ReceivedCommand& command : input_->take_commands()) {
            command_handler_.handle(command);
            output_->post_result(command_handler_.answer());
            if (recorder_ && command_handler_.answer().accepted()) {
                const scene::Snapshot& s = simulation_->snapshot();
                assessment_->log({s.time_ns, s.step + 1, command.name, static_cast<double>(command.value),
                                  sanitized_text(command.sender), command.id});
            }
        }
    }

    /// Waits for a silent device; commands are still handled.
    void pause(StepClock& clock) {
        clock.pause();
        latch(clock);
        if (output_ && paused_steps_++ % steps_per_status == 0) {
            StatusValues now = status(clock);
            now.phase = msg::PHASE_FROZEN;
            output_->post_status(now);
            if (paused_steps_ > steps_until_silent) {
                haptic_publisher_->post_visible_proxy(simulation_->snapshot());
            }
        }
    }

    void step(const StepClock& clock) {
        paused_steps_ = 0;
        simulation_->scene().step(inputs_, proxy_moved_);
        const scene::Snapshot& s = simulation_->snapshot();
        if (output_) {
            haptic_publisher_->post_forces(s);
            output_->post(s, status(clock));
            lab_->post(s, simulation_->scene().tissue().body().particles.position);
        }
        if (s.step % steps_per_second == 0) {
            log_state();
        }
        assessment_->submit(s, input_ ? input_->eye() : std::nullopt);
    }

    /// Records the state hash.
    void log_state() {
        const scene::Snapshot& s = simulation_->snapshot();
        if (recorder_ && s.step != last_logged_state_) {
            last_logged_state_ = s.step;
            assessment_->log(session::StateRecord{s.time_ns, s.step, state_hash()});
        }
    }

    [[nodiscard]] std::string state_hash() const {
        return fmt::format("{:016x}", simulation_->scene().state_hash());
    }

    void report_progress(const StepClock& clock) {
        threads_.update();
        if (const std::string found = force_limit_monitor_.check(
                simulation_->snapshot(), operator_ ? std::string_view(operator_->blade_stage()) : "");
            !found.empty()) {
            spdlog::warn("{}", found);
        }
        const double behind = clock.behind();
        if (behind > warned_behind_ + 2.0) {
            warned_behind_ = behind;
            spdlog::warn("simulation time is {:.1f} s behind the clock (load {:.0f} %){}", behind,
                         100.0 * clock.load(),
                         quality_ == Quality::full
                             ? ". Remedy: --quality reduced, or clients on another machine"
                             : "");
        }
        if (const std::string found = saliva_monitor_.check(simulation_->snapshot().saliva); !found.empty()) {
            spdlog::warn("{}", found);
        }
        // The demo reads its progress from this line.
        if (!options_.fast && simulation_->snapshot().step % steps_per_second == 0) {
            const std::string pace = fmt::format("simulation time {:.0f} s, {:.1f} s behind the clock",
                                                 simulation_->time(), behind);
            spdlog::info("{}", pace);
            service_.say(pace);
        }
    }

    [[nodiscard]] StatusValues status(const StepClock& clock) const {
        return {msg::PHASE_RUNNING, static_cast<float>(clock.load()), static_cast<float>(clock.behind()),
                laryngoscope_.presence, tube_.presence};
    }

    [[nodiscard]] bool ended() {
        if (all_ended() || command_handler_.next()) {
            return true;
        }
        if (options_.steps && simulation_->snapshot().step >= *options_.steps) {
            return true;
        }
        if (options_.duration > 0.0 && simulation_->time() >= options_.duration) {
            return true;
        }
        if (const double attempt = assessment_->ended_at();
            options_.finish_after_attempt && attempt >= 0.0 &&
            simulation_->time() >= attempt + linger_after_attempt) {
            return true;
        }
        return !options_.loop && operator_done();
    }

    /// Whether the operator's script has ended and the tissue has had time to recover.
    [[nodiscard]] bool operator_done() {
        if (!operator_ || !operator_->finished()) {
            return false;
        }
        if (operator_done_at_ < 0.0) {
            operator_done_at_ = simulation_->time();
        }
        return simulation_->time() >= operator_done_at_ + linger_after_operator;
    }

    void report(const StepClock& clock) const {
        if (clock.behind() > 0.1) {
            spdlog::info("simulation time fell {:.2f} s behind the clock in {} late steps", clock.behind(),
                         clock.late_steps());
        }
        if (!options_.json) {
            const metrics::AttemptSummary run = simulation_->metrics().run();
            spdlog::info("{}: {}",
                         !run.outcome.known    ? "outcome unknown"
                         : run.outcome.success ? "success"
                                               : "no success",
                         run.outcome.reason);
            return;
        }
        nlohmann::ordered_json out = result_json(summaries_of(simulation_->metrics()));
        out["scenario"] = scenario_.name;
        out["quality"] = name_of(quality_);
        out["steps"] = simulation_->snapshot().step;
        out["state_hash"] = state_hash();
        out["step_ms"] = {{"p50", 1e3 * clock.percentile(0.5)},
                          {"p99", 1e3 * clock.percentile(0.99)},
                          {"max", 1e3 * clock.max_cost()}};
        out["build"] = build_description();
        out["step_budget_ms"] = 1e3 / steps_per_second;
        out["behind_s"] = clock.behind();
        std::cout << out.dump(2) << std::endl;
    }

    Options options_;
    Scenario scenario_;
    SolverThreads& threads_;
    scene::Inputs inputs_;
    bool live_;  // real-time session with the bus
    Quality quality_ = Quality::full;
    patient::Patient patient_;
    std::unique_ptr<Simulation> simulation_;
    std::optional<OperatorScript> script_;
    std::optional<LocalOperator> operator_;
    std::optional<bus::Node> bus_;
    std::optional<BusInput> input_;
    std::optional<AnnotationBoard> board_;
    LogThrottle annotations_refused_;
    std::optional<HapticPublisher> haptic_publisher_;
    std::optional<BusOutput> output_;
    std::optional<LabOutput> lab_;
    std::optional<Recorder> recorder_;
    std::optional<AssessmentThread> assessment_;
    std::function<void(const scene::ProxySnapshot&)> proxy_moved_;
    std::string priority_refusal_;  // empty: not refused
    CommandHandler command_handler_;
    ForceLimitMonitor force_limit_monitor_;
    ServiceNotify service_;
    DeviceState laryngoscope_{"laryngoscope"}, tube_{"tube"};
    std::uint64_t paused_steps_ = 0;       // in this pause
    std::uint64_t last_logged_state_ = 0;  // step
    double operator_done_at_ = -1.0;       // [s], simulation time
    double pass_began_ = 0.0;              // [s], simulation time, start of the operator's script
    std::uint64_t pass_first_step_ = 0;
    std::uint64_t passes_ = 0;  // completed passes of the operator's script
    bool reset_ = false;        // requested internally, not by a command
    double warned_behind_ = 0.0;
    double behind_ = 0.0;  // [s], at the end
    SalivaMonitor saliva_monitor_;
};

/// File of the session with this number: x.eti.h5, x-2.eti.h5, ...
std::filesystem::path numbered_record(const std::filesystem::path& record, std::size_t number) {
    if (record.empty() || number < 2) {
        return record;
    }
    const std::string name = record.filename().string();
    const std::size_t stem = std::min(name.find('.', 1), name.size());
    return record.parent_path() / fmt::format("{}-{}{}", name.substr(0, stem), number, name.substr(stem));
}

}  // namespace

int run_server(const Options& options) {
    if (!options.replay.file.empty()) {
        // It simulates nothing, and takes no share.
        const tbb::global_control control(
            tbb::global_control::max_allowed_parallelism,
            options.threads > 0 ? static_cast<std::size_t>(options.threads) : usable_processors());
        return replay(options);
    }
    SolverThreads threads(static_cast<unsigned>(options.threads));
    if (!options.resimulate.empty()) {
        return resimulate(options);
    }
    std::vector<Scenario> scenarios;
    for (const std::string& name : options.scenarios) {
        scenarios.push_back(load_scenario(find_data_file(name, "scenarios")));
    }
    int status = 0;
    Options session_options = options;
    for (std::size_t i = 0; i < scenarios.size(); ++i) {
        session_options.record = numbered_record(options.record, i + 1);
        Session session(session_options, scenarios[i], i + 1 < scenarios.size(), threads);
        status = std::max(status, session.run());
        if (session_options.quality == Quality::automatic && session.fell_behind()) {
            spdlog::info("the next session's quality is '{}', as this one fell behind the clock",
                         name_of(Quality::reduced));
            session_options.quality = Quality::reduced;
        }
        if (session.all_ended()) {
            break;
        }
    }
    return status;
}

}  // namespace eti::app
