// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/speed/sleep.hpp"

#include <spdlog/spdlog.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "common/model/pace.hpp"
#include "common/operator/operator.hpp"
#include "server/app/run/local_operator.hpp"
#include "server/app/run/simulation.hpp"
#include "tests/bench/server/table.hpp"

namespace eti::bench {

namespace {

constexpr double longest_course = 120.0;  // [s] of simulation time
constexpr double quick_course = 2.0;      // [s]
constexpr int rest_steps = 3 * steps_per_second;
constexpr int after_steps = 10 * steps_per_second;
constexpr int steps_per_row = steps_per_second / 10;
/// Effect of a small cause: the blade shifted sideways by these [m].
constexpr std::array<std::array<float, 2>, 4> besides = {
    {{1e-6f, 0.0f}, {-1e-6f, 0.0f}, {0.0f, 1e-6f}, {0.0f, -1e-6f}}};
constexpr double off = 0.005;  // of the maximum: a larger difference counts as off

/// Processor time [ms]: other load on the machine affects it less than wall time.
double processor_ms() {
    timespec now{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

double ms_of(app::Simulation& simulation, const scene::Inputs& inputs) {
    const double before = processor_ms();
    simulation.scene().step(inputs);
    const double took = processor_ms() - before;
    simulation.assessor().observe(simulation.snapshot(), std::nullopt);
    return took;
}

/// Share of the particles not held by bone that the last step solved.
double share_awake(const scene::Scene& scene) {
    const pbd::Particles& p = scene.tissue().body().particles;
    std::size_t free = 0;
    std::size_t awake = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        free += p.inverse_mass[i] > 0.0f ? 1 : 0;
    }
    p.for_awake([&](std::uint32_t i) { awake += p.inverse_mass[i] > 0.0f ? 1 : 0; });
    return static_cast<double>(awake) / static_cast<double>(free);
}

/// Compared quantities: forces [N], view [%].
enum Measure : std::size_t { blade, tongue, gum, view, measures };
constexpr std::array<const char*, measures> measure_names = {"blade_n", "tongue_n", "gum_n", "view_percent"};

std::array<double, measures> measured(const app::Simulation& simulation) {
    const metrics::TissueForces forces = metrics::tissue_forces(simulation.snapshot());
    return {static_cast<double>(simulation.snapshot().tissue_force.norm()), forces.tongue, forces.gum,
            static_cast<double>(simulation.metrics().live().measures.glottic_opening_percent)};
}

/// Distance [m] between the same tissue in two scenes.
struct Apart {
    double squares = 0.0;
    std::size_t count = 0;
    double greatest = 0.0;

    void add(const scene::Scene& a, const scene::Scene& b) {
        const pbd::Particles& p = a.tissue().body().particles;
        const pbd::Particles& q = b.tissue().body().particles;
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (p.inverse_mass[i] > 0.0f) {
                const auto squared = static_cast<double>((p.position[i] - q.position[i]).squaredNorm());
                squares += squared;
                ++count;
                greatest = std::max(greatest, squared);
            }
        }
    }
    [[nodiscard]] double rms() const {
        return std::sqrt(squares / std::max(1.0, static_cast<double>(count)));
    }
    [[nodiscard]] double most() const { return std::sqrt(greatest); }
};

/// A scene that follows the reference's path, and its deviation.
struct FollowedScene {
    app::Simulation simulation;
    std::array<double, measures> greatest{}, mean{};
    std::array<std::vector<double>, measures> differences;  // a step
    Apart apart;

    void add(const std::array<double, measures>& here, const std::array<double, measures>& reference) {
        for (std::size_t m = 0; m < measures; ++m) {
            greatest[m] = std::max(greatest[m], here[m]);
            mean[m] += here[m];
            differences[m].push_back(std::abs(here[m] - reference[m]));
        }
    }
    [[nodiscard]] double difference_rms(std::size_t m) const {
        double squares = 0.0;
        for (const double d : differences[m]) {
            squares += d * d;
        }
        return std::sqrt(squares / static_cast<double>(differences[m].size()));
    }
    /// Share [%] of the steps that differ by more than `limit`.
    [[nodiscard]] double off_percent(std::size_t m, double limit) const {
        const auto those =
            std::count_if(differences[m].begin(), differences[m].end(), [&](double d) { return d > limit; });
        return 100.0 * static_cast<double>(those) / static_cast<double>(differences[m].size());
    }
};

/// "min,max" of `value` over the shifted scenes.
template <typename Value>
std::string range_beside(std::span<const FollowedScene> those, Value value) {
    std::vector<double> values(those.size());
    std::transform(those.begin(), those.end(), values.begin(), value);
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    return fmt::format(",{:.4f},{:.4f}", *least, *most);
}

void compare(const std::string& name, const Scenario& shipped, const SleepOptions& options, Table& table,
             Table& course) {
    Scenario awake = shipped;
    awake.physics.sleep = false;
    Scenario sleeping = awake;
    sleeping.physics.sleep = true;
    const std::string_view model_name = name_of(shipped.physics.tissue_method);
    const OperatorScript script = load_operator(find_data_file("expert", "operators"));
    const patient::Patient patient = app::patient_of(awake);
    scene::Inputs inputs = app::parked_inputs(awake, patient);
    // All awake, with sleeping, and all awake with the shifted blade: these follow, in this order.
    std::array<FollowedScene, 2 + besides.size()> scenes = {
        FollowedScene{{awake, patient, inputs}, {}, {}, {}, {}},
        FollowedScene{{sleeping, patient, inputs}, {}, {}, {}, {}},
        FollowedScene{{awake, patient, inputs}, {}, {}, {}, {}},
        FollowedScene{{awake, patient, inputs}, {}, {}, {}, {}},
        FollowedScene{{awake, patient, inputs}, {}, {}, {}, {}},
        FollowedScene{{awake, patient, inputs}, {}, {}, {}, {}}};
    const auto led_beside = std::span<const FollowedScene>(scenes).subspan(2);
    app::Simulation& reference = scenes[0].simulation;

    // At rest, tools away.
    std::array<double, 2> rest_ms{};
    for (int k = 0; k < rest_steps; ++k) {
        for (std::size_t s = 0; s < rest_ms.size(); ++s) {
            const double took = ms_of(scenes[s].simulation, inputs);
            rest_ms[s] += 2 * k >= rest_steps ? took / (rest_steps / 2) : 0.0;
        }
    }
    const double rest_awake = share_awake(scenes[1].simulation.scene());

    app::LocalOperator hands(script, reference.scope(), awake.tube, awake.seed ^ script.seed,
                             reference.observation());
    hands.apply_to(inputs);
    for (FollowedScene& f : scenes) {
        f.simulation.scene().reset(inputs);
    }
    std::array<double, 2> all_ms{}, row_ms{};
    double all_awake = 0.0;
    Apart row_apart;
    int steps = 0;
    const double end = reference.time() + (options.quick ? quick_course : longest_course);
    while (!hands.finished() && reference.time() < end) {
        hands.advance(reference.observation(), reference.snapshot());
        hands.apply_to(inputs);
        ++steps;
        for (std::size_t s = 0; s < scenes.size(); ++s) {
            scene::Inputs own = inputs;
            if (s >= 2) {
                own.laryngoscope.translation.x() += besides[s - 2][0];
                own.laryngoscope.translation.y() += besides[s - 2][1];
            }
            const double took = ms_of(scenes[s].simulation, own);
            if (s < all_ms.size()) {
                all_ms[s] += took;
                row_ms[s] += took / steps_per_row;
            }
        }
        const double share = share_awake(scenes[1].simulation.scene());
        all_awake += share;
        const std::array<double, measures> there = measured(reference);
        for (FollowedScene& f : scenes) {
            f.add(measured(f.simulation), there);
        }
        if (steps % steps_per_row != 0) {
            continue;
        }
        std::string row =
            fmt::format("{},{},{:.1f}", name, model_name, static_cast<double>(steps) / steps_per_second);
        for (std::size_t m = 0; m < measures; ++m) {
            for (std::size_t s = 0; s <= 2; ++s) {
                row += fmt::format(",{:.4g}", measured(scenes[s].simulation)[m]);
            }
        }
        for (std::size_t s = 1; s < scenes.size(); ++s) {
            Apart now;
            now.add(scenes[s].simulation.scene(), reference.scene());
            scenes[s].apart.add(scenes[s].simulation.scene(), reference.scene());
            row += s <= 2 ? fmt::format(",{:.3g},{:.3g}", 1e3 * now.rms(), 1e3 * now.most()) : "";
        }
        course.row(row + fmt::format(",{:.1f},{:.3f},{:.3f}", 100.0 * share, row_ms[0], row_ms[1]));
        row_ms = {};
    }
    // The tools stay where the attempt left them.
    for (int k = 0; k < after_steps && !options.quick; ++k) {
        scenes[1].simulation.scene().step(inputs);
    }
    const double after_awake = share_awake(scenes[1].simulation.scene());
    const auto count = static_cast<double>(steps);
    std::string row = fmt::format("{},{},{},{:.1f},{:.3f},{:.3f},{:.4f},{:.1f},{:.3f},{:.3f},{:.3f},{:.1f}",
                                  name, model_name, steps, 100.0 * rest_awake, rest_ms[0], rest_ms[1],
                                  rest_ms[1] / rest_ms[0], 100.0 * all_awake / count, all_ms[0] / count,
                                  all_ms[1] / count, all_ms[1] / all_ms[0], 100.0 * after_awake);
    for (std::size_t m = 0; m < measures; ++m) {
        const double limit = off * scenes[0].greatest[m];
        const FollowedScene& asleep = scenes[1];
        row += fmt::format(",{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f}", scenes[0].greatest[m],
                           scenes[0].mean[m] / count, asleep.greatest[m], asleep.mean[m] / count,
                           asleep.difference_rms(m), asleep.off_percent(m, limit));
        row += range_beside(led_beside, [&](const FollowedScene& f) { return f.mean[m] / count; });
        row += range_beside(led_beside, [&](const FollowedScene& f) { return f.difference_rms(m); });
        row += range_beside(led_beside, [&](const FollowedScene& f) { return f.off_percent(m, limit); });
    }
    row += fmt::format(",{:.4f},{:.4f}", 1e3 * scenes[1].apart.rms(), 1e3 * scenes[1].apart.most());
    row += range_beside(led_beside, [](const FollowedScene& f) { return 1e3 * f.apart.rms(); });
    table.row(row);
    spdlog::info(
        "{} {}: {:.1f} % awake at rest, {:.3f} of the time; {:.0f} % awake in the attempt, {:.2f} of the "
        "time; {:.1f} % awake ten seconds later; blade {:.3f} N, asleep {:.3f} N",
        name, model_name, 100.0 * rest_awake, rest_ms[1] / rest_ms[0], 100.0 * all_awake / count,
        all_ms[1] / all_ms[0], 100.0 * after_awake, scenes[0].greatest[blade], scenes[1].greatest[blade]);
}

}  // namespace

int sleep(const SleepOptions& options) {
    std::string header =
        "scenario,model,steps,rest_awake_percent,rest_step_ms,rest_step_sleep_ms,rest_ratio,awake_percent,"
        "step_ms,"
        "step_sleep_ms,ratio,after_awake_percent";
    std::string course_header = "scenario,model,time_s";
    for (const char* const measure : measure_names) {
        header += fmt::format(
            ",{0}_max,{0}_mean,{0}_sleep_max,{0}_sleep_mean,{0}_sleep_difference_rms,{0}_sleep_off_percent,"
            "{0}_beside_mean_least,{0}_beside_mean_most,{0}_beside_difference_rms_least,"
            "{0}_beside_difference_rms_most,{0}_beside_off_percent_least,{0}_beside_off_percent_most",
            measure);
        course_header += fmt::format(",{0},{0}_sleep,{0}_beside", measure);
    }
    header += ",shape_sleep_rms_mm,shape_sleep_max_mm,shape_beside_rms_mm_least,shape_beside_rms_mm_most";
    course_header += ",shape_sleep_rms_mm,shape_sleep_max_mm,shape_beside_rms_mm,shape_beside_max_mm";
    Table table(options.out, "sleep.csv", header);
    Table course(options.out, "sleep-course.csv", course_header + ",awake_percent,step_ms,step_sleep_ms");
    for (const std::string& name : options.scenarios) {
        const Scenario shipped = load_scenario(find_data_file(name, "scenarios"));
        compare(shipped.name, shipped, options, table, course);
    }
    spdlog::info("wrote {}", table.path().string());
    return 0;
}

}  // namespace eti::bench
