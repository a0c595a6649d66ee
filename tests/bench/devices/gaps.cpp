// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/devices/gaps.hpp"

#include <spdlog/spdlog.h>

#include <array>
#include <string_view>
#include <vector>

#include "tests/bench/server/table.hpp"
#include "tests/validation/haptics/closed_loop.hpp"

namespace eti::bench {

namespace {

using namespace validation;
using devices::SafetySettings;

struct GapSurface {
    std::string_view name;
    Medium medium;
    Move move;
    float stiffness;
};

/// As shipped.
std::array<GapSurface, 3> gap_surfaces() {
    return {{
        {"wall", Medium::wall, Move::press, CouplingSettings{}.stiffness},
        {"tissue", Medium::tissue, Move::press,
         devices::tissue_stiffness()[static_cast<std::size_t>(Tissue::tongue)]},
        {"levering", Medium::wall, Move::lever, CouplingSettings{}.rotational_stiffness},
    }};
}

/// How long forces are held, and when they have faded [s].
struct Hold {
    double held, gone;

    [[nodiscard]] SafetySettings settings() const {
        SafetySettings out;
        out.silence_limit = static_cast<float>(gone);
        out.held_share = static_cast<float>(held / gone);
        return out;
    }
};

Hold shipped() {
    const SafetySettings settings;
    return {static_cast<double>(settings.stale_after()), static_cast<double>(settings.silence_limit)};
}

constexpr Hold let_go{0.017, 0.020};  // rejected: docs/decisions/haptic-forces.md
constexpr Hold held_on{10.0, 11.0};

enum class Pattern : std::uint8_t { once, regular, random, bursts };
constexpr std::array<std::string_view, 4> pattern_names = {"once", "regular", "random", "bursts"};

Gaps gaps_of(Pattern pattern, double longest) {
    constexpr double never = 100.0;  // [s]
    Gaps gaps{.shortest = longest, .longest = longest, .caught_up = true};
    switch (pattern) {
        case Pattern::once:
            gaps.every = never;
            break;
        case Pattern::regular:
            break;
        case Pattern::random:
            gaps.shortest = 1.0 / 180.0;
            gaps.every = 0.05;
            break;
        case Pattern::bursts:
            gaps.every = 0.3;
            gaps.in_a_row = 3;
            break;
    }
    return gaps;
}

/// One patient under one hand.
struct Scene {
    GapSurface surface;
    Grip grip;
    double speed;  ///< [m/s], as Moving's

    [[nodiscard]] LoopCase loop(Pattern pattern) const {
        constexpr double far = 0.010;  // [m], more than the hand follows
        LoopCase out;
        out.medium = surface.medium;
        out.move = surface.move;
        out.stiffness = surface.stiffness;
        out.grip = grip;
        out.patient.speed = speed;
        if (pattern == Pattern::once) {
            out.patient.reach = far;
        }
        return out;
    }
};

void run(const Scene& scene, Pattern pattern, const std::vector<double>& lengths,
         const std::vector<Hold>& holds, Table& table) {
    LoopCase loop = scene.loop(pattern);
    const HeldHand without = hold_on(loop);
    for (const Hold& hold : holds) {
        for (const double length : lengths) {
            loop.safety = hold.settings();
            loop.gaps = gaps_of(pattern, length);
            const GapOutcome o = compare(hold_on(loop), without);
            table.row(fmt::format("{},{},{},{:g},{:g},{:g},{:g},{:.3f},{:.3f},{:.1f},{:.3f},{:.3f}",
                                  scene.surface.name, scene.grip.name,
                                  pattern_names[static_cast<std::size_t>(pattern)], 1e3 * scene.speed,
                                  1e3 * length, 1e3 * hold.held, 1e3 * hold.gone, 1e3 * o.excursion,
                                  1e3 * o.away, 1e2 * o.whole, o.rise, o.force));
        }
    }
}

}  // namespace

void press_through_gaps(const GapsOptions& options) {
    // [m/s]. Head and jaw rotate at 0.17 rad/s each at most, and no part of the gums is farther than 59 mm
    // from the neck's joint and 46 mm from the jaw's. That makes 10 mm/s of the upper gum, 19 of the lower.
    constexpr double fastest = 0.020, usual = 0.010;
    Table table(options.out, "haptics-gaps.csv",
                "surface,grip,pattern,patient_mm_per_s,gap_ms,held_ms,gone_ms,excursion_mm,away_rms_mm,"
                "whole_percent,rise_n_in_10_ms,force_n");
    std::vector<double> lengths, single;
    for (const int ms : {10, 20, 30, 50, 75, 100, 125, 150, 175, 200}) {
        lengths.push_back(1e-3 * ms);
    }
    for (int ms = 10; ms <= 300; ms += 10) {
        single.push_back(1e-3 * ms);
    }
    for (const GapSurface& surface : gap_surfaces()) {
        for (const Grip& grip : {firm, light}) {
            for (const double speed : {fastest, usual, -fastest}) {
                run({surface, grip, speed}, Pattern::once, single, {let_go, held_on}, table);
            }
            if (options.quick) {
                return;
            }
            for (const double speed : {0.0, usual, fastest}) {
                for (const Pattern pattern : {Pattern::regular, Pattern::random, Pattern::bursts}) {
                    run({surface, grip, speed}, pattern, lengths, {let_go, shipped(), held_on}, table);
                }
            }
            spdlog::info("{}, {}: pressed through gaps", surface.name, grip.name);
        }
    }
    spdlog::info("wrote {}", table.path().string());
}

}  // namespace eti::bench
