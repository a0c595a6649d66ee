// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Blocks of tissue deformed and released; the lowest layer is always held.
#include <functional>

#include "common/math/random.hpp"
#include "tests/bench/server/stability/stability_parts.hpp"

namespace eti::bench {

namespace {

constexpr double blocks_watched = 3.0;  // [s]
constexpr double block_side = 10e-3;    // [m]
constexpr std::string_view block_figure = "blocks";

Vec3d uniform(Random& random) {
    return {double{random.uniform()}, double{random.uniform()}, double{random.uniform()}};
}

Vec3d normal(Random& random) {
    return {double{random.normal()}, double{random.normal()}, double{random.normal()}};
}

struct Disturbance {
    std::string name;
    std::function<Vec3d(const Vec3d& rest, Random& random)> position;
};

const std::vector<Disturbance>& disturbances() {
    static const std::vector<Disturbance> list = {
        {"stretch x2", [](const Vec3d& p, Random&) { return Vec3d(p.x(), p.y(), 2.0 * p.z()); }},
        {"stretch x10", [](const Vec3d& p, Random&) { return Vec3d(p.x(), p.y(), 10.0 * p.z()); }},
        {"turned 180 deg",
         [](const Vec3d& p, Random&) { return Vec3d(block_side - p.x(), block_side - p.y(), p.z()); }},
        {"upset 180 deg", [](const Vec3d& p, Random&) { return Vec3d(p.x(), block_side - p.y(), -p.z()); }},
        {"flat", [](const Vec3d& p, Random&) { return Vec3d(p.x(), p.y(), 0.0); }},
        {"one line",
         [](const Vec3d& p, Random&) { return Vec3d(0.5 * block_side, 0.5 * block_side, p.z()); }},
        {"inverted", [](const Vec3d& p, Random&) { return Vec3d(p.x(), p.y(), -p.z()); }},
        // A micron apart: coincident points would have no direction.
        {"one point",
         [](const Vec3d&, Random& random) {
             return Vec3d(Vec3d::Constant(0.5 * block_side) + 1e-6 * normal(random));
         }},
        {"random", [](const Vec3d&, Random& random) { return Vec3d(block_side * uniform(random)); }}};
    return list;
}

struct Release {
    Disturbance disturbance = disturbances().front();
    double mass_ratio = 1.0;    ///< one half is lighter by this
    double static_share = 0.0;  ///< of the particles above the lowest layer
};

RecoveryResult release(const BodySettings& setting, const Release& how) {
    BlockBody body(10, 10, 10, setting);
    pbd::Particles& p = body.particles();
    Random random(1);
    double thrown = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const Vec3d rest = body.lattice().position[i];
        if (rest.z() < 1e-9 || double{random.uniform()} < how.static_share) {
            body.hold(i);
            continue;
        }
        if (rest.x() > 0.5 * block_side) {
            body.scale_mass(i, 1.0 / how.mass_ratio);
        }
        const Vec3d start = how.disturbance.position(rest, random);
        thrown = std::max(thrown, (start - rest).norm());
        p.position[i] = start.cast<float>();
    }
    RecoveryTracker tracker(block_side, blocks_watched);
    double time = 0.0;
    body.watch = [&](const pbd::Particles& particles) {
        time += setting.step;
        tracker.observe(time, farthest_from_rest(particles), kinetic_energy(particles));
        for (const Quatf& rotation : body.shapes().rotation()) {
            tracker.observe(rotation);
        }
    };
    body.settle(blocks_watched);
    return tracker.result(thrown);
}

/// Without damping and external force kinetic energy oscillates, but its peaks must not grow. Survives if
/// they do not, recovers while they stay below the energy of the first second's peak plus a tenth.
RecoveryResult undamped(BodySettings setting) {
    setting.damping = 0.0;
    const Disturbance slight = {"stretch by a tenth",
                                [](const Vec3d& p, Random&) { return Vec3d(p.x(), p.y(), 1.1 * p.z()); }};
    RecoveryResult course = release(setting, {.disturbance = slight});
    course.return_time = course.residual = RecoveryResult::none;
    const double growth = course.kinetic_growth;
    course.fate = growth <= 1.0 ? Fate::survives : growth <= 1.1 ? Fate::recovers : Fate::fails;
    return course;
}

}  // namespace

void blocks_thrown_and_released(const Sweep& sweep, StabilityTable& maps) {
    for (const Method method : sweep.methods) {
        for (const auto& [column, rate] : columns_of(sweep, method)) {
            const auto add = [&, &column = column](std::string_view map, std::string_view row,
                                                   const auto& course) {
                maps.add(block_figure, map, name_of(method), row, column, course);
            };
            for (const double modulus : {8e1, 8e2, 8e3, 8e4, 8e5, 8e6, 8e7}) {
                const BodySettings setting = with_rate(method, rate, modulus);
                const std::string row = fmt::format("{:g} kPa", 1e-3 * modulus);
                add("stiffness", row, [&] { return release(setting, {}); });
                add("undamped: kinetic energy", row, [&] { return undamped(setting); });
            }
            for (const double ratio : {1.0, 10.0, 100.0, 1e3, 1e4}) {
                add("mass ratio", fmt::format("1:{:g}", ratio),
                    [&, rate = rate] { return release(with_rate(method, rate), {.mass_ratio = ratio}); });
            }
            for (const double share : {0.1, 0.5, 0.9}) {
                add("static among moving", fmt::format("{:g} % static", 100.0 * share),
                    [&, rate = rate] { return release(with_rate(method, rate), {.static_share = share}); });
            }
            for (const Disturbance& disturbance : disturbances()) {
                add("disturbance", disturbance.name, [&, rate = rate] {
                    return release(with_rate(method, rate), {.disturbance = disturbance});
                });
            }
        }
    }
}

}  // namespace eti::bench
