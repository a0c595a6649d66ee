// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/spdlog.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "devices/app/program.hpp"
#include "devices/haptics/haptic_loop.hpp"

namespace eti::devices {
namespace {

constexpr double late_cycle = 1.2e-3;  // [s]
constexpr std::chrono::milliseconds poll_interval{20};

nlohmann::ordered_json statistics(const Program& program, const SceneLink& link, const HapticLoop& loop) {
    const HapticCycle& cycle = loop.cycle();
    const HapticRecord& record = cycle.record();
    const CycleStatistics& intervals = record.intervals;
    const auto share = [&](std::uint64_t cycles) {
        return intervals.count() > 0
                   ? static_cast<double>(cycles) / static_cast<double>(intervals.count() + 1)
                   : 0.0;
    };
    nlohmann::ordered_json out;
    out["device"] = program.options().device;
    out["session"] = program.options().bus.session;
    out["ended"] = program.ended();
    out["duration_s"] = program.seconds();
    out["cycles"] = intervals.count() + 1;
    out["cycle_ms"] = {{"p50", 1e3 * intervals.percentile(0.5)},
                       {"p99", 1e3 * intervals.percentile(0.99)},
                       {"p99_9", 1e3 * intervals.percentile(0.999)},
                       {"max", 1e3 * intervals.longest()}};
    out["late_share"] = intervals.share_over(late_cycle);
    out["real_time"] = loop.priority_refusal().empty();
    out["force_n"] = {{"max", record.force_max},
                      {"mean", record.force_sum / static_cast<double>(intervals.count() + 1)}};
    out["engaged_share"] = share(record.engaged_cycles);
    out["stale_share"] = share(record.stale_cycles);
    out["not_finite_cycles"] = cycle.renderer().not_finite();
    out["poses_published"] = loop.published();
    out["states_received"] = link.received();
    out["messages_refused"] = link.refused();
    out["outages"] = link.outages();
    return out;
}

void log(const nlohmann::ordered_json& s) {
    spdlog::info(
        "{} cycles; ms from one to the next: p50 {:.3f}, p99 {:.3f}, p99.9 {:.3f}, max {:.3f}; {:.3f} % "
        "later than 1.2 ms",
        s["cycles"].get<std::uint64_t>(), s["cycle_ms"]["p50"].get<double>(),
        s["cycle_ms"]["p99"].get<double>(), s["cycle_ms"]["p99_9"].get<double>(),
        s["cycle_ms"]["max"].get<double>(), 100.0 * s["late_share"].get<double>());
    spdlog::info("force max {:.2f} N, mean {:.2f} N; engaged {:.1f} %, scene stale {:.1f} % of the time",
                 s["force_n"]["max"].get<double>(), s["force_n"]["mean"].get<double>(),
                 100.0 * s["engaged_share"].get<double>(), 100.0 * s["stale_share"].get<double>());
    if (s["messages_refused"].get<std::uint64_t>() > 0) {
        spdlog::warn(
            "{} messages were refused: not finite or not of this version; do server and device match?",
            s["messages_refused"].get<std::uint64_t>());
    }
}

int run(const ProgramOptions& options, const RenderSettings& settings) {
    Program program(options, Tool::laryngoscope);
    const std::unique_ptr<Sensor> sensor = program.open_sensor();
    if (!sensor) {
        spdlog::info("ended ({}) before the server was heard", program.ended());
        if (options.json) {
            std::cout << nlohmann::ordered_json{{"device", options.device},
                                                {"session", options.bus.session},
                                                {"ended", program.ended()},
                                                {"cycles", 0}}
                             .dump(2)
                      << std::endl;
        }
        return 0;
    }
    HapticLoop loop(program.node(), *sensor, program.link().newest(), settings);
    if (!loop.priority_refusal().empty()) {
        spdlog::warn("{}", loop.priority_refusal());
    }
    while (!program.should_end()) {
        std::this_thread::sleep_for(poll_interval);
    }
    loop.stop();
    spdlog::info("ended: {}", program.ended());
    const auto result = statistics(program, program.link(), loop);
    log(result);
    if (options.json) {
        std::cout << result.dump(2) << std::endl;
    }
    return 0;
}

}  // namespace
}  // namespace eti::devices

int main(int argc, char** argv) {
    using namespace eti::devices;
    set_up_process("eti-haptics");
    ProgramOptions options;
    options.bus.name = "eti-haptics";
    RenderSettings settings;
    float stale_ms = 1e3f * settings.safety.stale_after;
    CLI::App app(
        "The haptic device: a 1 kHz loop that lets the hand feel the scene and tells the server where it is.",
        "eti-haptics");
    add_options(app, options, eti::Tool::laryngoscope);
    std::string soft_force = "constraint";
    app.add_option("--soft-force", soft_force,
                   "Force of soft tissue: 'constraint' (the simulation's contact forces) or 'displacement' "
                   "(mean displacement times stiffness, Xiao et al. 2020)")
        ->capture_default_str()
        ->check(CLI::IsMember({"constraint", "displacement"}));
    app.add_option(
           "--stale-ms", stale_ms,
           "Forces fade after this time without a message [ms]; more bridges a late server's gaps, at "
           "the cost of feeling an old scene for as long")
        ->capture_default_str()
        ->check(CLI::Range(5.0f, 1000.0f));
    if (const auto code = parse(app, argc, argv)) {
        return *code;
    }
    settings.soft_force = soft_force == "displacement" ? SoftForce::displacement : SoftForce::constraint;
    settings.safety.stale_after = 1e-3f * stale_ms;
    try {
        return run(options, settings);
    } catch (const std::exception& error) {
        spdlog::error("{}", error.what());
        return 1;
    }
}
