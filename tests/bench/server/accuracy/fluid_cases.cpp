// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <chrono>
#include <cmath>
#include <vector>

#include "common/model/pace.hpp"
#include "tests/bench/server/accuracy/accuracy_table.hpp"
#include "tests/validation/fluid/dam_break.hpp"

namespace eti::bench {

namespace {

constexpr double gravity = 9.81;  // [m/s^2]
constexpr std::string_view fluid_method = "fluid";

/// A column of 10 x 10 mm and 20 mm depth comes to rest in its vessel in 0.6 s, and is measured in the last
/// fifth.
struct LiquidColumn {
    std::size_t particles = 0;
    double pressure_error = 0.0;  ///< RMS over the particles, relative to the pressure at the bottom
    double volume_error = 0.0;    ///< of twice the height of the centre of mass
    double frame_ms = 0.0;
};

LiquidColumn column(double spacing, int substeps, int iterations) {
    constexpr double wide = 10e-3;
    constexpr double high = 20e-3;
    constexpr double seconds = 0.6;
    const int across = static_cast<int>(std::lround(wide / spacing));
    const int layers = static_cast<int>(std::lround(high / spacing));
    pbd::FluidSettings settings;
    settings.spacing = static_cast<float>(spacing);
    settings.iterations = iterations;
    settings.rest_time = 0.0f;  // a sleeping fluid has no cost to compare
    settings.capacity = static_cast<std::size_t>(across * across * layers);
    settings.lower = Vec3f::Constant(-5.0f * settings.spacing);
    settings.upper = Vec3f(0.0f, 0.0f, static_cast<float>(2.0 * high)) + Vec3f::Constant(0.02f);
    // Only pressure and volume are compared: no surface tension, and walls with free slip.
    settings.surface_tension = 0.0f;
    settings.wall_viscosity = 0.0f;
    pbd::Fluid fluid(settings);
    for (int z = 0; z < layers; ++z) {
        for (int y = 0; y < across; ++y) {
            for (int x = 0; x < across; ++x) {
                fluid.add(settings.spacing *
                          (Vec3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)) +
                           Vec3f::Constant(0.5f)));
            }
        }
    }
    const DistanceGrid vessel = test::vessel(Vec3d(wide, wide, 2.0 * high).cast<float>(), settings.spacing);
    pbd::FluidSurroundings surroundings;
    surroundings.solid = &vessel;
    const auto dt = static_cast<float>(1.0 / (steps_per_second * substeps));
    const int count = static_cast<int>(std::lround(seconds * steps_per_second * substeps));
    LiquidColumn out;
    out.particles = fluid.count();
    std::vector<double> pressure(fluid.count(), 0.0), height(fluid.count(), 0.0);
    int samples = 0;
    double wall = 0.0;
    for (int n = 0; n < count; ++n) {
        const auto before = std::chrono::steady_clock::now();
        fluid.step(dt, Vec3f(0.0f, 0.0f, static_cast<float>(-gravity)), surroundings);
        wall += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count();
        if (n < 0.8 * count) {
            continue;
        }
        ++samples;
        for (std::size_t i = 0; i < fluid.count(); ++i) {
            const std::uint32_t id = fluid.ids()[i];  // indices change, ordinal numbers do not
            pressure[id] += static_cast<double>(fluid.pressure(i));
            height[id] += static_cast<double>(fluid.positions()[i].z());
        }
    }
    double squared = 0.0;
    double centre = 0.0;
    for (std::size_t i = 0; i < pressure.size(); ++i) {
        const double z = height[i] / samples;
        centre += z / static_cast<double>(pressure.size());
        const double expected = std::max(high - z, 0.0) / high;
        squared += std::pow(pressure[i] / samples / (1000.0 * gravity * high) - expected, 2);
    }
    out.pressure_error = std::sqrt(squared / static_cast<double>(pressure.size()));
    out.volume_error = std::fabs(2.0 * centre / high - 1.0);
    out.frame_ms = wall / (seconds * 90.0);
    return out;
}

}  // namespace

void pour_water(AccuracyTable& table, bool quick) {
    const std::vector<int> substeps = quick ? std::vector{8} : std::vector{2, 4, 8, 16};
    const std::vector<int> iterations = quick ? std::vector{5} : std::vector{2, 5, 10};
    for (const double spacing : quick ? std::vector{2e-3} : std::vector{2e-3, 1e-3}) {
        for (const int s : substeps) {
            for (const int k : iterations) {
                if (!table.shard().claim_next()) {
                    continue;
                }
                const LiquidColumn c = column(spacing, s, k);
                table.add({"fluid-pressure", fluid_method, spacing, s, k, c.particles, c.pressure_error,
                           c.frame_ms});
                table.add(
                    {"fluid-volume", fluid_method, spacing, s, k, c.particles, c.volume_error, c.frame_ms});
            }
        }
    }
    for (const int columns : quick ? std::vector{8} : std::vector{8, 16}) {
        for (const int s : substeps) {
            if (columns * s > 128) {
                continue;  // the front no longer changes, and it would take a minute
            }
            for (const int k : iterations) {
                if (!table.shard().claim_next()) {
                    continue;
                }
                const auto before = std::chrono::steady_clock::now();
                const test::DamBreak dam =
                    test::dam_break(columns, 6, static_cast<float>(1.0 / (steps_per_second * s)), k);
                const std::chrono::duration<double, std::milli> wall =
                    std::chrono::steady_clock::now() - before;
                table.add({"dam-break", fluid_method, 57.15e-3 / columns, s, k, dam.particles,
                           static_cast<double>(dam.error()), wall.count() / (dam.simulated * 90.0)});
            }
        }
    }
}

}  // namespace eti::bench
