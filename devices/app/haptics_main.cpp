// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/spdlog.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>

#include "common/process/terminal.hpp"
#include "common/process/threads/priority.hpp"
#include "devices/app/program.hpp"
#include "devices/haptics/haptic_loop.hpp"

namespace eti::devices {
namespace {

constexpr double late_cycle = 1.2e-3;  // [s]
constexpr double max_stale = 0.05;     // fraction of the time
constexpr std::chrono::milliseconds poll_interval{5};

volatile std::sig_atomic_t panic_signals = 0;

nlohmann::ordered_json statistics(const Program& program, const HapticLoop& loop) {
    const HapticCycle& cycle = loop.cycle();
    const HapticRecord& record = cycle.record();
    const CycleStatistics& intervals = record.intervals;
    const auto share = [&](std::uint64_t cycles) {
        return intervals.count() > 0
                   ? static_cast<double>(cycles) / static_cast<double>(intervals.count() + 1)
                   : 0.0;
    };
    nlohmann::ordered_json out;
    out["cycles"] = intervals.count() + 1;
    out["cycle_ms"] = {{"p50", 1e3 * intervals.percentile(0.5)},
                       {"p99", 1e3 * intervals.percentile(0.99)},
                       {"p99_9", 1e3 * intervals.percentile(0.999)},
                       {"max", 1e3 * intervals.longest()}};
    out["late_share"] = intervals.share_over(late_cycle);
    out["real_time"] = loop.priority_refusal().empty();
    out["message_ms"] = {{"p50", 1e3 * record.messages.percentile(0.5)},
                         {"p99", 1e3 * record.messages.percentile(0.99)},
                         {"max", 1e3 * record.messages.longest()}};
    out["force_n"] = {{"max", record.force_max},
                      {"mean", record.force_sum / static_cast<double>(intervals.count() + 1)}};
    out["compute_us"] = {{"p50", 1e6 * record.computing.percentile(0.5)},
                         {"p99", 1e6 * record.computing.percentile(0.99)},
                         {"max", 1e6 * record.computing.longest()}};
    const PassivityController& passivity = cycle.renderer().passivity();
    out["energy_mj"] = {{"stored", 1e3 * passivity.stored()},
                        {"lowest", 1e3 * passivity.lowest()},
                        {"dissipated", 1e3 * passivity.dissipated()}};
    out["passivity_share"] = share(passivity.active_cycles());
    out["engaged_share"] = share(record.engaged_cycles);
    out["stopped_share"] = share(record.emergency_stop_cycles);
    out["absent_share"] = share(record.absent_cycles);
    out["stale_share"] = share(record.stale_cycles);
    out["not_finite_cycles"] = cycle.renderer().not_finite();
    out["poses_published"] = loop.published();
    out["round_trip_ms"] =
        program.round_trip_ms() ? nlohmann::ordered_json(*program.round_trip_ms()) : nullptr;
    return out;
}

void log(const nlohmann::ordered_json& s) {
    spdlog::info(
        "{} cycles; period in ms: p50 {:.3f}, p99 {:.3f}, p99.9 {:.3f}, max {:.3f}; {:.3f} % later than 1.2 "
        "ms",
        s["cycles"].get<std::uint64_t>(), s["cycle_ms"]["p50"].get<double>(),
        s["cycle_ms"]["p99"].get<double>(), s["cycle_ms"]["p99_9"].get<double>(),
        s["cycle_ms"]["max"].get<double>(), 100.0 * s["late_share"].get<double>());
    spdlog::info(
        "force max {:.2f} N, mean {:.2f} N; engaged {:.1f} %, faded {:.1f} % of the time; interval of "
        "messages in ms: p50 {:.1f}, p99 {:.1f}, max {:.1f}",
        s["force_n"]["max"].get<double>(), s["force_n"]["mean"].get<double>(),
        100.0 * s["engaged_share"].get<double>(), 100.0 * s["stale_share"].get<double>(),
        s["message_ms"]["p50"].get<double>(), s["message_ms"]["p99"].get<double>(),
        s["message_ms"]["max"].get<double>());
    spdlog::info(
        "computation took p50 {:.0f}, p99 {:.0f} us per cycle; energy: lowest {:.2f} mJ, {:.2f} mJ "
        "dissipated by the passivity controller, which acted in {:.2f} % of the cycles",
        s["compute_us"]["p50"].get<double>(), s["compute_us"]["p99"].get<double>(),
        s["energy_mj"]["lowest"].get<double>(), s["energy_mj"]["dissipated"].get<double>(),
        100.0 * s["passivity_share"].get<double>());
    if (s["stale_share"].get<double>() > max_stale) {
        spdlog::warn(
            "messages were missing for so long that forces were reduced for {:.0f} % of the time; run the "
            "server on a faster machine, or bridge longer gaps with --silence-ms",
            100.0 * s["stale_share"].get<double>());
    }
}

/// Emergency stop: SIGUSR1, any terminal key but 'r', or a closed terminal remove the force; 'r' restores
/// forces.
void handle_emergency_stop(Terminal& terminal, HapticLoop& loop) {
    static std::sig_atomic_t heeded = 0;
    const std::optional<char> key = terminal.key(std::chrono::milliseconds(0));
    if (panic_signals != heeded || (key && *key != 'r')) {
        heeded = panic_signals;
        loop.set_emergency_stop(true);
        spdlog::warn("forces are off; press r to restore them");
    } else if (key && *key == 'r') {
        loop.set_emergency_stop(false);
        spdlog::info("forces return when the device is free of contact");
    }
}

int run(const ProgramOptions& options, RenderSettings settings) {
    // The bus's threads are part of the haptic path, too.
    std::optional<RealTimeThreads> real_time(priority::bus);
    Program program(options, settings.tool);
    const std::string bus_refusal = real_time->refusal();
    real_time.reset();
    program.run([&](SensorMonitor& watch) {
        const DeviceCapabilities capabilities = watch.capabilities();
        settings.coupling.force_limit = std::min(settings.coupling.force_limit, capabilities.force);
        settings.coupling.torque_limit = std::min(settings.coupling.torque_limit, capabilities.torque);
        settings.torque = capabilities.torque > 0.0f;
        settings.gimbal = program.gimbal();
        if (capabilities.force <= 0.0f) {
            spdlog::warn("device '{}' has no motors: no forces are felt", options.device);
        }
        Terminal terminal;
        HapticLoop loop(program.node(), watch, program.link().newest(), settings);
        if (terminal.there()) {
            spdlog::info("any key turns forces off at once (panic key); r restores them");
        }
        if (const std::string& refusal =
                loop.priority_refusal().empty() ? bus_refusal : loop.priority_refusal();
            !refusal.empty()) {
            spdlog::warn("{}", refusal);
        }
        std::uint64_t seen_cycles = 0;
        while (!program.should_end()) {
            std::this_thread::sleep_for(poll_interval);
            // A device that runs the loop itself stops it when unplugged, which is not a fault of this
            // process.
            if (const std::uint64_t now = loop.cycles(); now != seen_cycles || loop.on_servo()) {
                seen_cycles = now;
                program.alive();
            }
            watch.poll_events();
            program.report(watch);
            program.watch_latency();
            handle_emergency_stop(terminal, loop);
        }
        loop.stop();
        const auto result = statistics(program, loop);
        log(result);
        return result;
    });
    return 0;
}

}  // namespace
}  // namespace eti::devices

int main(int argc, char** argv) {
    using namespace eti::devices;
    ProgramOptions options;
    options.bus.name = "eti-haptics";
    RenderSettings settings;
    float silence_ms = 1e3f * settings.safety.silence_limit;
    eti::CommandLine app(
        "The haptic device: a 1 kHz loop that renders forces to the hand and sends its pose to the server.",
        "eti-haptics");
    options.haptic = true;
    add_options(app, options);
    std::string tool = "laryngoscope";
    app.add_option("--tool", tool, "Tool that the device holds")
        .capture_default_str()
        .one_of({"laryngoscope", "tube"});
    app.add_flag("!--no-passivity-control", settings.passivity.on,
                 "Observe the energy without dissipating any; for measurements without a hand");
    std::string soft_force = "constraint";
    app.add_option("--soft-force", soft_force,
                   "Force of soft tissue: 'constraint' (the simulation's contact forces) or 'displacement' "
                   "(mean displacement times stiffness, Xiao et al. 2020)")
        .capture_default_str()
        .one_of({"constraint", "displacement"});
    // From about the gap that needs no bridging (SafetySettings::gap) to one second.
    app.add_number("--silence-ms", silence_ms,
                   "Forces are zero after this time without a message; they are held for the first third of "
                   "it and fade over the rest. A larger value bridges longer gaps of a late server, but "
                   "renders outdated forces for as long",
                   {20.0f, 1000.0f, "ms"})
        .capture_default_str();
    const auto work = [&] {
        settings.soft_force = soft_force == "displacement" ? SoftForce::displacement : SoftForce::constraint;
        settings.safety.silence_limit = 1e-3f * silence_ms;
        settings.tool = tool == "tube" ? eti::Tool::tube : eti::Tool::laryngoscope;
        std::signal(SIGUSR1, [](int) { panic_signals = panic_signals + 1; });
        return run(options, settings);
    };
    return eti::run_program(app, argc, argv, work, device_signals);
}
