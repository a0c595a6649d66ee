// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/devices/haptics.hpp"

#include <spdlog/spdlog.h>

#include <array>
#include <string>
#include <vector>

#include "common/device/hand.hpp"
#include "tests/bench/devices/gaps.hpp"
#include "tests/bench/devices/grid.hpp"
#include "tests/bench/devices/live.hpp"
#include "tests/bench/devices/tongue_laws.hpp"
#include "tests/bench/server/table.hpp"
#include "tests/validation/haptics/closed_loop.hpp"

namespace eti::bench {

namespace {

using devices::SoftForce;
using namespace validation;

struct RenderedSurface {
    std::string_view name;
    Medium medium;
    SoftForce law;
};
constexpr std::array<RenderedSurface, 3> rendered_surfaces = {{
    {"wall", Medium::wall, SoftForce::constraint},
    {"tissue, constraint forces", Medium::tissue, SoftForce::constraint},
    {"tissue, displacements", Medium::tissue, SoftForce::displacement},
}};

constexpr double period = 1e-3;  // [s]

/// Damping of the device apart from the rendered one [N s/m].
double damping_of(const Grip& grip) {
    return static_cast<double>(HandSettings{}.device_damping + grip.damping);
}

double virtual_damping_of(Medium medium) {
    return medium == Medium::wall ? static_cast<double>(CouplingSettings{}.damping) : 0.0;
}

/// Passive for any hand: b > K T / 2 + B (Colgate & Schenkel 1997), with the hand's damping in b.
double passive_stiffness(const RenderedSurface& surface, const Grip& grip) {
    return 2.0 * (damping_of(grip) - virtual_damping_of(surface.medium)) / period;
}

/// Stable with a force delayed by t: K < (b + B) / (T / 2 + t) (Gil, Sanchez, Hulin, Preusche & Hirzinger
/// 2009).
double stable_stiffness(const RenderedSurface& surface, const Grip& grip, double delay) {
    return (damping_of(grip) + virtual_damping_of(surface.medium)) / (0.5 * period + delay);
}

void map_stability(const HapticsOptions& options) {
    Table table(options.out, "haptics-stability.csv",
                "surface,grip,passivity,delay_ms,jitter_ms,loss_percent,stable_n_per_m,passive_bound_n_per_m,"
                "delayed_bound_n_per_m");
    const std::vector<double> delays =
        options.quick ? std::vector{0.0, 0.010} : std::vector{0.0, 0.005, 0.010, 0.020, 0.030, 0.040, 0.050};
    const std::vector<double> losses = options.quick ? std::vector{0.01} : std::vector{0.0, 0.01, 0.02, 0.05};
    for (const RenderedSurface& surface : rendered_surfaces) {
        for (const Grip& grip : {firm, light}) {
            for (const bool passivity : {false, true}) {
                for (const double delay : delays) {
                    for (const double loss : losses) {
                        LoopCase loop;
                        loop.medium = surface.medium;
                        loop.law = surface.law;
                        loop.passivity = passivity;
                        loop.grip = grip;
                        loop.channel = {delay, 0.1 * delay, loss};
                        table.row(fmt::format(
                            "\"{}\",{},{},{:g},{:g},{:g},{:.0f},{:.0f},{:.0f}", surface.name, grip.name,
                            passivity ? 1 : 0, 1e3 * delay, 1e3 * loop.channel.jitter, 1e2 * loss,
                            largest_stable_stiffness(loop), passive_stiffness(surface, grip),
                            stable_stiffness(surface, grip, delay)));
                    }
                }
                spdlog::info("{}, {}, passivity controller {}: mapped", surface.name, grip.name,
                             passivity ? "on" : "off");
            }
        }
    }
    spdlog::info("wrote {}", table.path().string());
}

void map_levering(const HapticsOptions& options) {
    Table table(
        options.out, "haptics-levering.csv",
        "motors,grip,passivity,delay_ms,jitter_ms,loss_percent,stable_nm_per_rad,shipped_excursion_mm");
    const std::vector<double> delays =
        options.quick ? std::vector{0.0, 0.010} : std::vector{0.0, 0.005, 0.010, 0.020, 0.030, 0.040, 0.050};
    const std::vector<double> losses = options.quick ? std::vector{0.01} : std::vector{0.0, 0.01, 0.05};
    for (const Motors motors : {Motors::six, Motors::three}) {
        for (const Grip& grip : {firm, light}) {
            for (const bool passivity : {false, true}) {
                for (const double delay : delays) {
                    for (const double loss : losses) {
                        LoopCase loop;
                        loop.move = Move::lever;
                        loop.motors = motors;
                        loop.passivity = passivity;
                        loop.grip = grip;
                        loop.stiffness = CouplingSettings{}.rotational_stiffness;
                        loop.channel = {delay, 0.1 * delay, loss};
                        table.row(fmt::format(
                            "{},{},{},{:g},{:g},{:g},{:.2f},{:.4f}", motors == Motors::six ? 6 : 3, grip.name,
                            passivity ? 1 : 0, 1e3 * delay, 1e3 * loop.channel.jitter, 1e2 * loss,
                            largest_stable_stiffness(loop), 1e3 * run_loop(loop).excursion));
                    }
                }
            }
        }
    }
    spdlog::info("wrote {}", table.path().string());
}

void compare_stiffness(const HapticsOptions& options) {
    Table table(
        options.out, "haptics-rendered.csv",
        "surface,passivity,delay_ms,loss_percent,set_n_per_m,rendered_n_per_m,onset_ms,excursion_mm,dip_mm,"
        "energy_lowest_mj,dissipated_mj");
    for (const RenderedSurface& surface : rendered_surfaces) {
        for (const bool passivity : {false, true}) {
            for (const double delay : {0.0, 0.010, 0.020, 0.050}) {
                for (const float stiffness : {100.0f, 200.0f, 400.0f, 800.0f, 1200.0f}) {
                    LoopCase loop;
                    loop.medium = surface.medium;
                    loop.law = surface.law;
                    loop.passivity = passivity;
                    loop.stiffness = stiffness;
                    loop.channel = {delay, 0.1 * delay, delay > 0.0 ? 0.01 : 0.0};
                    const LoopOutcome o = run_loop(loop);
                    table.row(
                        fmt::format("\"{}\",{},{:g},{:g},{:g},{:.1f},{:.0f},{:.4f},{:.4f},{:.4f},{:.4f}",
                                    surface.name, passivity ? 1 : 0, 1e3 * delay, 1e2 * loop.channel.loss,
                                    stiffness, o.rendered, 1e3 * o.onset, 1e3 * o.excursion, 1e3 * o.dip,
                                    1e3 * o.energy_lowest, 1e3 * o.dissipated));
                }
            }
        }
    }
    spdlog::info("wrote {}", table.path().string());
}

void run_beside_a_server(const HapticsOptions& options) {
    Table table(options.out, "haptics-live.csv", "run,quantity,value,unit");
    const auto loop_rows = [&](std::string_view run, const LoopTiming& t) {
        const auto row = [&](std::string_view quantity, double value, std::string_view unit) {
            table.row(fmt::format("\"{}\",{},{:.6g},{}", run, quantity, value, unit));
        };
        row("period_p50", 1e3 * t.period_p50, "ms");
        row("period_p99", 1e3 * t.period_p99, "ms");
        row("period_p99_9", 1e3 * t.period_p999, "ms");
        row("period_max", 1e3 * t.period_max, "ms");
        row("late_share", 1e2 * t.late_share, "%");
        row("compute_p99", 1e6 * t.compute_p99, "us");
        row("real_time", t.real_time ? 1.0 : 0.0, "1");
    };
    // Against the machine's baseline, measured in the same way at the same time.
    spdlog::info("only a timer, and the loop without a server: {:.0f} s", options.live_seconds);
    loop_rows("empty loop", run_empty_loop(0.5 * options.live_seconds, false));
    loop_rows("loop without a server", run_loop_alone(0.5 * options.live_seconds));
    spdlog::info("a timer beside a server: {:.0f} s", 0.5 * options.live_seconds);
    loop_rows("empty loop beside a server", run_empty_loop(0.5 * options.live_seconds, true));
    const std::vector<LiveCase> runs = {
        {"bus alone", std::nullopt, options.live_seconds},
        {"10 ms, 1 % lost", Channel{0.010, 0.001, 0.01}, 0.5 * options.live_seconds},
    };
    for (const LiveCase& live : runs) {
        spdlog::info("{}: {:.0f} s beside a server", live.name, live.seconds);
        const LiveOutcome o = run_live(live);
        const auto row = [&](std::string_view quantity, double value, std::string_view unit) {
            table.row(fmt::format("\"{}\",{},{:.6g},{}", live.name, quantity, value, unit));
        };
        loop_rows(live.name, o.loop);
        row("round_trip_p50", 1e3 * o.round_trip_p50, "ms");
        row("round_trip_p99", 1e3 * o.round_trip_p99, "ms");
        row("force_mean", o.force_mean, "N");
        row("force_max", o.force_max, "N");
        row("message_p99", 1e3 * o.message_p99, "ms");
        row("message_max", 1e3 * o.message_max, "ms");
        row("held_excursion", 1e3 * o.excursion, "mm");
        row("held_stillest", 1e3 * o.min_excursion, "mm");
        row("held_force", o.held_force, "N");
        row("stale_share", 1e2 * o.stale_share, "%");
        row("energy_lowest", 1e3 * o.energy_lowest, "mJ");
        row("dissipated", 1e3 * o.dissipated, "mJ");
        row("passivity_share", 1e2 * o.passivity_share, "%");
        row("server_behind", o.server_behind, "s");
    }
    spdlog::info("wrote {}", table.path().string());
}

void press_over_the_bus(const HapticsOptions& options) {
    Table table(
        options.out, "haptics-grid.csv",
        "passivity,delay_ms,jitter_ms,loss_percent,stiffness_n_per_m,not_measured,stable,excursion_mm,"
        "force_n,faded_percent,server_lag_percent,message_p99_ms,message_max_ms,relay_late_ms,"
        "virtual_stable,virtual_excursion_mm");
    int measured = 0, agreed = 0, cells = 0;
    run_grid({.whole = options.whole_grid, .minutes = options.grid_minutes}, [&](const GridCell& cell,
                                                                                 const GridOutcome& o) {
        LoopCase loop;
        loop.stiffness = cell.stiffness;
        loop.passivity = cell.passivity;
        loop.grip = light;
        loop.channel = cell.channel;
        const double virtually = run_loop(loop).excursion;
        const bool counts = o.not_measured.empty();
        ++cells;
        measured += counts ? 1 : 0;
        agreed += counts && o.stable() == (virtually <= most_excursion) ? 1 : 0;
        table.row(fmt::format(
            "{},{:g},{:g},{:g},{:g},{},{},{:.4f},{:.3f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{},{:.4f}",
            cell.passivity ? 1 : 0, 1e3 * cell.channel.delay, 1e3 * cell.channel.jitter,
            1e2 * cell.channel.loss, cell.stiffness, o.not_measured, counts ? (o.stable() ? "1" : "0") : "",
            1e3 * o.excursion, o.force, 1e2 * o.faded, 1e2 * o.server_lag, 1e3 * o.message_p99,
            1e3 * o.message_max, 1e3 * o.relay_late, virtually <= most_excursion ? 1 : 0, 1e3 * virtually));
    });
    spdlog::info("{} cells over the bus, {} measured, {} of these as by the virtual clock", cells, measured,
                 agreed);
    spdlog::info("wrote {}", table.path().string());
}

void compare_laws(const HapticsOptions& options) {
    Table table(options.out, "haptics-laws.csv", "law,depth_mm,force_n,reference_n");
    for (const LawForce& row : tongue_laws(options.quick)) {
        table.row(fmt::format("{},{:g},{:.6g},{:.6g}", row.law, 1e3 * row.depth, row.force, row.reference));
    }
    spdlog::info("wrote {}", table.path().string());
}

}  // namespace

std::vector<std::string> haptics_table_names() {
    return {"stability", "gaps", "rendered", "laws", "grid", "live"};
}

int haptics(const HapticsOptions& options) {
    const auto wanted = [&](std::string_view name) { return options.only.empty() || options.only == name; };
    if (wanted("stability")) {
        map_stability(options);
        map_levering(options);
    }
    if (wanted("gaps")) {
        press_through_gaps({.out = options.out, .quick = options.quick});
    }
    if (wanted("rendered")) {
        compare_stiffness(options);
    }
    if (wanted("laws")) {
        compare_laws(options);
    }
    if (wanted("grid") && !options.quick) {
        press_over_the_bus(options);
    }
    if (wanted("live") && !options.quick && options.live_seconds > 0.0) {
        run_beside_a_server(options);
    }
    return 0;
}

}  // namespace eti::bench
