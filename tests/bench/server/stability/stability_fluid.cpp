// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Saliva squeezed between blade and floor, and between two capsules.
#include "common/model/pace.hpp"
#include "server/scene/saliva.hpp"
#include "tests/bench/server/stability/stability_parts.hpp"

namespace eti::bench {

namespace {

constexpr float fluid_spacing = 1e-3f;     // [m]
constexpr float capsule_radius = 3.5e-3f;  // [m], of the capsules
constexpr float open_gap = 6e-3f;
constexpr float closed_gap = 0.5e-3f;  // half a particle: all must leave
constexpr double fluid_watched = 2.0;  // [s]

/// A closed vessel of 40 x 24 x 30 mm: squeezed-out liquid splashes against its walls and returns.
DistanceGrid vessel() {
    const Vec3f lower(-20e-3f, -12e-3f, 0.0f), upper(20e-3f, 12e-3f, 30e-3f);
    DistanceGrid grid;
    grid.spacing = 1e-3f;
    grid.origin = lower - Vec3f::Constant(5e-3f);
    grid.size = {51, 35, 41};
    for (int z = 0; z < grid.size[2]; ++z) {
        for (int y = 0; y < grid.size[1]; ++y) {
            for (int x = 0; x < grid.size[0]; ++x) {
                const Vec3f node = grid.node(x, y, z);
                grid.value.push_back((node - lower).cwiseMin(upper - node).minCoeff());
            }
        }
    }
    return grid;
}

pbd::MovingCapsule capsule_between(float before, float now) {
    const Vec3f half(30e-3f, 0.0f, 0.0f);
    const auto up = [](float height) { return Vec3f(0.0f, 0.0f, height); };
    return {up(before) - half, up(before) + half, up(now) - half, up(now) + half, capsule_radius};
}

/// A gap of 6 mm that closes at `speed` [m/s] to half a particle, with the scene's saliva or with its full
/// surface tension. The fluid survives if no particle is lost, no particle centre is ever in a wall, and all
/// come to rest; it recovers if one was in a wall temporarily.
RecoveryResult squeeze(double rate, float speed, bool two_capsules, bool as_in_the_scene) {
    const DistanceGrid walls = vessel();
    const auto dt = static_cast<float>(1.0 / rate);
    pbd::FluidSettings settings = scene::saliva_settings(fluid_spacing, dt);
    if (!as_in_the_scene) {
        settings.surface_tension = pbd::FluidSettings{}.surface_tension;
    }
    pbd::Fluid fluid(settings);
    for (int k = 0; k < 12 * 6 * 4; ++k) {
        fluid.add(fluid_spacing * Vec3f(static_cast<float>(k % 12) - 5.5f,
                                        static_cast<float>(k / 12 % 6) - 2.5f,
                                        static_cast<float>(k / 72) + 0.5f));
    }
    const std::size_t filled = fluid.count();
    float gap = open_gap;
    double deepest = 0.0, overlap = 0.0, peak[2] = {0.0, 0.0};
    bool finite = true;
    double quiet_since = RecoveryResult::none;
    for (int n = 1; n <= static_cast<int>(fluid_watched * rate); ++n) {
        const float before = gap;
        gap = std::max(gap - speed * dt, closed_gap);
        // Two capsules close in on the middle of the pool, the lower one embedded in the floor.
        const float low_before = -capsule_radius + 0.5f * (open_gap - before),
                    low = -capsule_radius + 0.5f * (open_gap - gap);
        const pbd::MovingCapsule capsules[2] = {
            two_capsules ? capsule_between(low_before + before + 2.0f * capsule_radius,
                                           low + gap + 2.0f * capsule_radius)
                         : capsule_between(before + capsule_radius, gap + capsule_radius),
            capsule_between(low_before, low)};
        pbd::FluidSurroundings surroundings;
        surroundings.solid = &walls;
        surroundings.capsules = {capsules, two_capsules ? 2u : 1u};
        fluid.step(dt, Vec3f(0.0f, 0.0f, -9.81f), surroundings);
        overlap = 0.0;
        double kinetic = 0.0;
        for (std::size_t i = 0; i < fluid.count(); ++i) {
            const Vec3f& x = fluid.positions()[i];
            finite = finite && x.allFinite() && fluid.velocities()[i].allFinite();
            float clear = walls.distance(x);
            for (const pbd::MovingCapsule& c : surroundings.capsules) {
                const float t = closest_on_segment(c.a, c.b, x);
                clear = std::min(clear, (x - c.a - t * (c.b - c.a)).norm() - c.radius);
            }
            overlap = std::max(overlap, static_cast<double>(-clear));
            kinetic += 0.5 * static_cast<double>(fluid.particle_mass() * fluid.velocities()[i].squaredNorm());
        }
        deepest = std::max(deepest, overlap);
        peak[n > 0.5 * fluid_watched * rate ? 1 : 0] =
            std::max(peak[n > 0.5 * fluid_watched * rate ? 1 : 0], kinetic);
        // 20 mm/s on average: the residual motion of a film in balance of capillarity and gravity is below.
        const double speed_now = std::sqrt(2.0 * kinetic / static_cast<double>(fluid.particle_mass()) /
                                           static_cast<double>(std::max<std::size_t>(fluid.count(), 1)));
        if (!(speed_now < 0.02)) {
            quiet_since = RecoveryResult::none;
        } else if (std::isnan(quiet_since)) {
            quiet_since = n / rate;
        }
    }
    RecoveryResult course;
    course.return_time = quiet_since;
    course.residual = overlap / static_cast<double>(fluid_spacing);
    course.kinetic_growth = peak[1] / peak[0];
    const bool kept = finite && fluid.count() == filled;
    if (kept && !(overlap > 0.0) && !std::isnan(quiet_since)) {
        course.fate = deepest > 0.0 ? Fate::recovers : Fate::survives;
    }
    return course;
}

}  // namespace

void fluid_in_a_closing_gap(const Sweep& sweep, StabilityTable& maps) {
    const double scene_rate = steps_per_second * scene::Saliva::substeps;
    for (const double rate : sweep.quick ? std::vector{scene_rate} : sweep.rates) {
        for (const float speed : {0.01f, 0.1f, 1.0f, 3.0f}) {
            for (const bool two : {false, true}) {
                for (const bool as_in_the_scene : {true, false}) {
                    maps.add("contacts",
                             two ? "fluid between two capsules" : "fluid between capsule and floor",
                             as_in_the_scene ? "saliva" : "saliva, all its surface tension",
                             fmt::format("{:g} m/s", speed), step_name(rate),
                             [&] { return squeeze(rate, speed, two, as_in_the_scene); });
                }
            }
        }
    }
}

}  // namespace eti::bench
