// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/server.hpp"

#include <spdlog/spdlog.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <thread>
#include <utility>

#include "common/bus/bus.hpp"
#include "common/math/units.hpp"
#include "common/model/pace.hpp"
#include "common/operator/operator.hpp"
#include "common/process/priority.hpp"
#include "common/process/service_notify.hpp"
#include "common/process/stop_signal.hpp"
#include "common/scenario/scenario.hpp"
#include "common/scenario/yaml_map.hpp"
#include "server/app/annotation_board.hpp"
#include "server/app/bus_input.hpp"
#include "server/app/bus_output.hpp"
#include "server/app/clock.hpp"
#include "server/app/command_desk.hpp"
#include "server/app/felt_output.hpp"
#include "server/app/hand_watch.hpp"
#include "server/app/judge.hpp"
#include "server/app/lab_output.hpp"
#include "server/app/local_operator.hpp"
#include "server/app/recorder.hpp"
#include "server/app/replay.hpp"
#include "server/app/resimulation.hpp"
#include "server/app/session_info.hpp"
#include "server/app/simulation.hpp"
#include "server/parallel/worker_start.hpp"

namespace eti::app {

namespace {

constexpr double linger_after_attempt = 2.0;   // [s]
constexpr double linger_after_operator = 0.5;  // [s]
// The kernel keeps a twentieth of each second for ordinary threads. Rather more, so that they have had it:
// the solver's threads look for work a while before they sleep.
constexpr double left_to_others = 0.15;  // of a step

/// While it lives, the simulation goes before whatever is not between a hand and what it feels. Not for runs
/// that ignore the clock: they would leave nothing to others.
class Foremost {
  public:
    explicit Foremost(bool wanted) {
        if (wanted) {
            (void)become_real_time(priority::step);
            workers_.emplace([] { (void)become_real_time(priority::step); });
        }
    }
    ~Foremost() {
        if (workers_) {
            become_ordinary();
        }
    }
    Foremost(const Foremost&) = delete;
    Foremost& operator=(const Foremost&) = delete;

  private:
    std::optional<parallel::WorkerStart> workers_;
};

/// A tool's device, as last spoken of.
struct FollowedState {
    const char* name;
    msg::DevicePresence presence = msg::DEVICE_NONE;
    bool appeared = false;  // since the last step, for the first time
};

/// On a manikin nobody judges a view, so that a hand which waits for one goes on only by its timeout.
void warn_of_views(const OperatorScript& script) {
    for (const Track* track : {&script.laryngoscope, &script.tube}) {
        for (const Stage& stage : track->stages) {
            if (stage.until_view_percent > 0.0f && stage.timeout > 0.0f) {
                spdlog::warn(
                    "operator '{}', stage '{}': waits for {:g} % of the glottis to be seen, and a manikin "
                    "gives no view; it ends after {:g} s{}. Remedy: an operator without view_percent",
                    script.name, stage.name, stage.until_view_percent, stage.timeout,
                    stage.abort_on_timeout ? ", and the rest is skipped" : "");
            }
        }
    }
}

class Session {
  public:
    /// `followed`: another session comes after this one.
    Session(const Options& options, const Scenario& scenario, bool followed)
        : options_(options), scenario_(scenario), live_(options.with_bus && !options.fast) {
        if (!options.operator_name.empty()) {
            script_ = load_operator(find_data_file(options.operator_name, "operators"));
            script_->skill = options.skill.value_or(script_->skill);
            script_->attempts = options.attempts.value_or(script_->attempts);
            if (scenario.manikin) {
                warn_of_views(*script_);
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
        inputs_ = parked(scenario_, patient_);
        simulation_ = std::make_unique<Simulation>(scenario_, patient_, inputs_);
        desk_ = CommandDesk(limits_of(scenario_, patient_), inputs_.live, followed);
        if (script_) {
            put_operator();
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
            if (script_) {
                info.more[session::skill_text] = fmt::format("{:g}", script_->skill);
            }
            recorder_.emplace(options.record, std::move(info), patient_, simulation_->scope(), scenario_,
                              simulation_->snapshot(), options.fast);
            spdlog::info("recording to {}", options.record.string());
        }
        start_threads();
    }

    /// Whether everything was asked to end, and not this session alone.
    [[nodiscard]] bool all_ended() const { return stop_asked() || desk_.stopped(); }

    int run() {
        spdlog::info("session '{}' runs scenario '{}': {} particles, {} clusters, {} substeps",
                     options_.bus.session, scenario_.name, patient_.particles.size(),
                     patient_.clusters.size(), scenario_.physics.substeps);
        if (!priority_refusal_.empty()) {
            spdlog::warn("{}", priority_refusal_);
        }
        const bool real_time = live_ && priority_refusal_.empty();
        StepClock clock(step_duration, !options_.fast, real_time ? left_to_others : 0.0);
        {
            const Foremost foremost(live_);
            while (!ended()) {
                service_.alive();
                if (frozen()) {
                    stand_still(clock);
                    continue;
                }
                clock.wait();
                latch(clock);
                put_tools();
                step(clock);
                clock.done();
                say(clock);
            }
        }
        service_.ending();
        note_state();
        judge_->finish();
        const bool kept = !recorder_ || recorder_->finish();
        lab_.reset();
        if (output_) {
            felt_->finish();
            output_->finish(status(clock));
            if (const std::uint64_t skipped = felt_->skipped() + output_->skipped(); skipped > 0) {
                spdlog::info("{} states were replaced before they were sent", skipped);
            }
        }
        if (input_ && input_->refused() > 0) {
            spdlog::warn("{} poses were refused: not finite, or not within two metres of the patient",
                         input_->refused());
        }
        report(clock);
        return kept ? 0 : 3;
    }

  private:
    void start_threads() {
        if (bus_) {
            input_.emplace(*bus_);
            board_.emplace(patient_, laryngoscope_mesh(simulation_->scope()));
            {
                const RealTimeThreads real_time(priority::bus, live_);
                felt_.emplace(*bus_);
            }
            // Ordinary, it could be held up while it holds the bus's locks, and what is felt with it.
            const RealTimeThreads real_time(priority::step, live_);
            output_.emplace(*bus_, scenario_, patient_, simulation_->scope(), inputs_.live);
            lab_.emplace(*bus_, patient_, live_);
            proxy_moved_ = [this](const scene::ProxySnapshot& proxy) { felt_->post_proxy(proxy); };
        }
        const RealTimeThreads real_time(priority::beside, live_);
        // An operator in this process looks before each step; everybody else only hears of what was seen.
        const bool beside = !operator_;
        judge_.emplace(simulation_->assessor(), recorder_ ? &*recorder_ : nullptr,
                       output_ ? &*output_ : nullptr, beside);
    }

    /// The operator before the first stage of the script.
    void put_operator() {
        const std::uint64_t seed = options_.seed.value_or(scenario_.seed ^ script_->seed);
        pass_began_ = simulation_->time();
        pass_first_step_ = simulation_->snapshot().step;
        operator_.emplace(*script_, simulation_->scope(), scenario_.tube, seed, observed());
        operator_->hold(inputs_);
    }

    /// What the operator sees, as of the time since the script began.
    [[nodiscard]] Observation observed() const {
        Observation seen = simulation_->observation();
        seen.time -= pass_began_;
        return seen;
    }

    /// The operator's script from its beginning, as after the command that is recorded for it.
    void begin_again(const StepClock& clock) {
        const scene::Snapshot& s = simulation_->snapshot();
        const std::size_t steps = s.step - pass_first_step_;
        const metrics::AttemptSummary run = simulation_->metrics().run();
        // tests/bench/server/soak.py reads this line.
        spdlog::info(
            "pass {} ended at {:.1f} s after {} steps of {:.3f} ms, 99 % within {:.3f} ms; state {}; "
            "{} attempts",
            ++passes_, simulation_->time(), steps, 1e3 * clock.percentile(0.5, steps),
            1e3 * clock.percentile(0.99, steps), state_hash(), run.parameters.attempts);
        operator_done_at_ = -1.0;
        if (recorder_) {
            judge_->note(session::CommandRecord{s.time_ns, s.step + 1, "reset", 0.0, "operator", 0});
        }
        // The script aims at a patient at rest, and the patient rests around the tools that it then holds.
        simulation_->scene().reset(inputs_);
        put_operator();
        reset_ = true;
    }

    void latch(const StepClock& clock) {
        if (operator_ && operator_rested()) {
            begin_again(clock);
        } else if (operator_) {
            operator_->advance(observed(), simulation_->snapshot());
            operator_->hold(inputs_);
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
        // Whoever asks for more: the hand's button, or a command.
        inputs_.live = desk_.wanted();
        if (!operator_ && input_->suction()) {
            inputs_.live.suction = 1.0f;
        }
    }

    /// What happens to the tools at once. Right before a step, so that the inputs recorded with it say where
    /// they were put, also after time has stood still.
    void put_tools() {
        if (laryngoscope_.appeared) {
            simulation_->scene().place_laryngoscope(inputs_.laryngoscope);
        }
        if (tube_.appeared) {
            simulation_->scene().place_tube(inputs_.tube_grip);
        }
        laryngoscope_.appeared = tube_.appeared = false;
        if (desk_.take_reset() || std::exchange(reset_, false)) {
            simulation_->scene().reset(inputs_);
        }
    }

    void take_annotations() {
        for (const msg::Annotation& annotation : input_->take_annotations()) {
            AnnotationBoard::Taken taken = board_->take(annotation, simulation_->snapshot());
            if (!taken.refusal.empty()) {
                if (const auto kept_back = annotations_refused_.allow("annotation")) {
                    spdlog::warn("a mark of '{}' was left out: {}{}", annotation.sender().to_string(),
                                 taken.refusal, and_more(*kept_back));
                }
                continue;
            }
            spdlog::info("{} {}",
                         taken.event.kind == session::note_event ? "note of" : "marks:", taken.event.text);
            judge_->note(std::move(taken.event));
            if (taken.places) {
                judge_->note(std::move(*taken.places));
            }
            output_->post_shown(std::move(taken.shown));
        }
    }

    void follow_devices() {
        const auto follow = [this](const FollowedDevice& device, FollowedState& state,
                                   RigidTransform& input) {
            if (device.pose()) {
                state.appeared = state.appeared || state.presence == msg::DEVICE_NONE;
                input = *device.pose();
            }
            if (device.presence() != state.presence) {
                say_presence(state, device.presence());
            }
        };
        follow(input_->laryngoscope(), laryngoscope_, inputs_.laryngoscope);
        follow(input_->tube(), tube_, inputs_.tube_grip);
    }

    void say_presence(FollowedState& state, msg::DevicePresence now) {
        const bool back = state.presence == msg::DEVICE_SILENT;
        state.presence = now;
        if (now == msg::DEVICE_SILENT) {
            spdlog::warn("the {}'s device has been silent for {} ms; {}", state.name,
                         FollowedDevice::silence.count(),
                         scenario_.freeze_on_silence ? "time stands still until it is back"
                                                     : "the tool stays where it was");
        } else {
            spdlog::info("the {}'s device is {}", state.name, back ? "back" : "here");
        }
        const char* const what = now == msg::DEVICE_SILENT ? "silent" : back ? "back" : "here";
        judge_->note(session::EventRecord{simulation_->snapshot().time_ns, std::string(session::device_event),
                                          fmt::format("{} {}", state.name, what)});
    }

    [[nodiscard]] bool frozen() const {
        return scenario_.freeze_on_silence &&
               (laryngoscope_.presence == msg::DEVICE_SILENT || tube_.presence == msg::DEVICE_SILENT);
    }

    void take_commands() {
        for (const ReceivedCommand& command : input_->take_replaced()) {
            desk_.pass_over(command);
            output_->post_result(desk_.answer());
        }
        for (const ReceivedCommand& command : input_->take_commands()) {
            desk_.handle(command);
            output_->post_result(desk_.answer());
            if (recorder_ && desk_.answer().accepted()) {
                const scene::Snapshot& s = simulation_->snapshot();
                judge_->note({s.time_ns, s.step + 1, command.name, static_cast<double>(command.value),
                              readable(command.sender), command.id});
            }
        }
    }

    /// Waits for a silent device; commands are still taken.
    void stand_still(StepClock& clock) {
        clock.stand_still();
        latch(clock);
        if (output_ && stood_still_++ % steps_per_status == 0) {
            StatusValues now = status(clock);
            now.phase = msg::PHASE_FROZEN;
            output_->post_status(now);
        }
    }

    void step(const StepClock& clock) {
        simulation_->scene().step(inputs_, proxy_moved_);
        const scene::Snapshot& s = simulation_->snapshot();
        if (output_) {
            felt_->post_forces(s);
            output_->post(s, status(clock));
            lab_->post(s, simulation_->scene().tissue().body().particles.position);
        }
        if (s.step % steps_per_second == 0) {
            note_state();
        }
        judge_->take(s, input_ ? input_->eye() : std::nullopt);
    }

    /// Records what the state is in one number.
    void note_state() {
        const scene::Snapshot& s = simulation_->snapshot();
        if (recorder_ && s.step != state_noted_) {
            state_noted_ = s.step;
            judge_->note(session::StateRecord{s.time_ns, s.step, state_hash()});
        }
    }

    [[nodiscard]] std::string state_hash() const {
        return fmt::format("{:016x}", simulation_->scene().state_hash());
    }

    void say(const StepClock& clock) {
        if (const std::string found = hand_watch_.look(
                simulation_->snapshot(), operator_ ? std::string_view(operator_->blade_stage()) : "");
            !found.empty()) {
            spdlog::warn("{}", found);
        }
        const double behind = clock.behind();
        if (behind > warned_behind_ + 2.0) {
            warned_behind_ = behind;
            spdlog::warn("simulation time is {:.1f} s behind the clock (load {:.0f} %)", behind,
                         100.0 * clock.load());
        }
        if (simulation_->snapshot().saliva.overflow > 0 && !warned_of_overflow_) {
            warned_of_overflow_ = true;
            spdlog::warn(
                "mouth and throat hold as much saliva as is simulated ({} particles): more is left out. "
                "Suction makes room",
                simulation_->snapshot().saliva.positions.size());
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
        if (all_ended() || desk_.next()) {
            return true;
        }
        if (options_.steps && simulation_->snapshot().step >= *options_.steps) {
            return true;
        }
        if (options_.duration > 0.0 && simulation_->time() >= options_.duration) {
            return true;
        }
        if (const double attempt = judge_->ended_at();
            options_.finish_after_attempt && attempt >= 0.0 &&
            simulation_->time() >= attempt + linger_after_attempt) {
            return true;
        }
        return !options_.loop && operator_rested();
    }

    /// The operator's script has ended, and the tissue has had its time to come back.
    [[nodiscard]] bool operator_rested() {
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
                         clock.late());
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
        out["steps"] = simulation_->snapshot().step;
        out["state_hash"] = state_hash();
        out["step_ms"] = {{"p50", 1e3 * clock.percentile(0.5)},
                          {"p99", 1e3 * clock.percentile(0.99)},
                          {"max", 1e3 * clock.most()}};
        out["build"] = build_description();
        out["step_budget_ms"] = 1e3 / steps_per_second;
        out["behind_s"] = clock.behind();
        std::cout << out.dump(2) << std::endl;
    }

    Options options_;
    Scenario scenario_;
    scene::Inputs inputs_;
    bool live_;  // others wait for it, by the clock
    anatomy::Patient patient_;
    std::unique_ptr<Simulation> simulation_;
    std::optional<OperatorScript> script_;
    std::optional<LocalOperator> operator_;
    std::optional<bus::Node> bus_;
    std::optional<BusInput> input_;
    std::optional<AnnotationBoard> board_;
    LineLimit annotations_refused_;
    std::optional<FeltOutput> felt_;
    std::optional<BusOutput> output_;
    std::optional<LabOutput> lab_;
    std::optional<Recorder> recorder_;
    std::optional<Judge> judge_;
    std::function<void(const scene::ProxySnapshot&)> proxy_moved_;
    std::string priority_refusal_;  // empty: none was refused
    CommandDesk desk_;
    HandWatch hand_watch_;
    ServiceNotify service_;
    FollowedState laryngoscope_{"laryngoscope"}, tube_{"tube"};
    std::uint64_t stood_still_ = 0;   // steps
    std::uint64_t state_noted_ = 0;   // step
    double operator_done_at_ = -1.0;  // [s], simulation time
    double pass_began_ = 0.0;         // [s], simulation time, of the operator's script
    std::uint64_t pass_first_step_ = 0;
    std::uint64_t passes_ = 0;  // of the operator's script, ended
    bool reset_ = false;        // asked for by what goes on here, not by a command
    double warned_behind_ = 0.0;
    bool warned_of_overflow_ = false;
};

/// The record of the session of this number: x.eti.h5, x-2.eti.h5, ...
std::filesystem::path numbered(const std::filesystem::path& record, std::size_t number) {
    if (record.empty() || number < 2) {
        return record;
    }
    const std::string name = record.filename().string();
    const std::size_t stem = std::min(name.find('.', 1), name.size());
    return record.parent_path() / fmt::format("{}-{}{}", name.substr(0, stem), number, name.substr(stem));
}

}  // namespace

int run_server(const Options& options) {
    catch_stop_signals();
    const std::size_t threads = options.threads > 0 ? static_cast<std::size_t>(options.threads)
                                                    : std::max(1u, std::thread::hardware_concurrency());
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    try {
        if (!options.resimulate.empty()) {
            return resimulate(options);
        }
        if (!options.replay.file.empty()) {
            return replay(options);
        }
        std::vector<Scenario> scenarios;
        for (const std::string& name : options.scenarios) {
            scenarios.push_back(load_scenario(find_data_file(name, "scenarios")));
        }
        int status = 0;
        for (std::size_t i = 0; i < scenarios.size(); ++i) {
            Options of_session = options;
            of_session.record = numbered(options.record, i + 1);
            Session session(of_session, scenarios[i], i + 1 < scenarios.size());
            status = std::max(status, session.run());
            if (session.all_ended()) {
                break;
            }
        }
        return status;
    } catch (const std::exception& error) {
        spdlog::error("{}", error.what());
        return 1;
    }
}

}  // namespace eti::app
