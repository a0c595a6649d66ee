// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/speed/speed.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "server/parallel/loops.hpp"
#include "tests/bench/server/speed/speed_meter.hpp"

namespace eti::bench {

double SpeedMeter::fastest(const std::function<void()>& work) const {
    using Clock = std::chrono::steady_clock;
    const std::chrono::milliseconds enough(quick_ ? 5 : 500);
    const Clock::time_point start = Clock::now();
    double best = 1e300;
    for (int i = 0; i < 3 || (i < 400 && Clock::now() - start < enough); ++i) {
        const Clock::time_point before = Clock::now();
        work();
        best = std::min(best, std::chrono::duration<double, std::nano>(Clock::now() - before).count());
    }
    return best;
}

double SpeedMeter::bandwidth(double bytes) const {
    const auto count = static_cast<std::size_t>(bytes / (3.0 * sizeof(float)));
    std::vector<float> a(count, 0.0f), b(count, 1.0f), c(count, 2.0f);
    const double ns = fastest([&] {
        parallel::for_ranges(count, count / 8 + 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i != end; ++i) {
                a[i] = b[i] + 0.5f * c[i];
            }
        });
    });
    return static_cast<double>(3 * count * sizeof(float)) / ns;
}

pbd::Particles sheared_particles(const test::TetrahedralLattice& lattice) {
    pbd::Particles particles;
    particles.resize(lattice.position.size());
    for (std::size_t i = 0; i < particles.size(); ++i) {
        particles.rest[i] = lattice.position[i].cast<float>();
        particles.predicted[i] = particles.rest[i] + Vec3f(0.2f * particles.rest[i].z(), 0, 0);
        particles.inverse_mass[i] = 1.0f / 3.2e-5f;
    }
    particles.position = particles.predicted;
    return particles;
}

std::vector<std::array<std::uint32_t, 2>> edges_of(const test::TetrahedralLattice& lattice) {
    std::set<std::array<std::uint32_t, 2>> edges;
    for (const auto& corner : lattice.tetrahedra) {
        for (std::size_t a = 0; a < 4; ++a) {
            for (std::size_t b = a + 1; b < 4; ++b) {
                edges.insert({std::min(corner[a], corner[b]), std::max(corner[a], corner[b])});
            }
        }
    }
    return {edges.begin(), edges.end()};
}

namespace {

std::string processor() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
        if (line.starts_with("model name")) {
            return line.substr(line.find(':') + 2);
        }
    }
    return "unknown";
}

std::string full_name(const SpeedResult& r) {
    return fmt::format("{}, {} thread{}", r.name, r.threads, r.threads == 1 ? "" : "s");
}

nlohmann::ordered_json as_json(const std::vector<SpeedResult>& results) {
    nlohmann::ordered_json out;
    out["machine"] = processor();
    out["threads"] = std::thread::hardware_concurrency();
    out["results"] = nlohmann::ordered_json::array();
    for (const SpeedResult& r : results) {
        nlohmann::ordered_json entry{{"name", full_name(r)}, {"value", r.value}, {"unit", r.unit}};
        if (r.bound) {
            entry["bound"] = *r.bound;
        }
        if (r.peer) {
            entry["peer"] = *r.peer;
        }
        out["results"].push_back(std::move(entry));
    }
    return out;
}

std::string number(std::optional<double> value) {
    return value ? fmt::format("{:.3g}", *value) : "";
}

/// One line per part, with columns for the numbers of threads, each with its memory bound.
void print_table(const std::vector<SpeedResult>& results, const std::vector<int>& threads) {
    std::cout << processor() << "\n\n| part |";
    for (const int n : threads) {
        std::cout << fmt::format(" {} thread{} | bound |", n, n == 1 ? "" : "s");
    }
    std::cout << " unit | Bullet |\n|---|";
    for (std::size_t i = 0; i < 2 * threads.size() + 2; ++i) {
        std::cout << "---|";
    }
    std::cout << "\n";
    std::vector<std::string> names;
    for (const SpeedResult& r : results) {
        if (std::ranges::find(names, r.name) == names.end()) {
            names.push_back(r.name);
        }
    }
    for (const std::string& name : names) {
        std::cout << "| " << name << " |";
        std::string unit;
        std::optional<double> peer;
        for (const int n : threads) {
            const auto r = std::ranges::find_if(
                results, [&](const SpeedResult& x) { return x.name == name && x.threads == n; });
            if (r == results.end()) {
                std::cout << " | |";
                continue;
            }
            std::cout << fmt::format(" {} | {} |", number(r->value), number(r->bound));
            unit = r->unit;
            peer = r->peer ? r->peer : peer;
        }
        std::cout << fmt::format(" {} | {} |\n", unit, number(peer));
    }
}

}  // namespace

int speed(const SpeedOptions& options) {
    std::vector<SpeedResult> results;
    for (const int threads : options.threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(threads));
        SpeedMeter meter(threads, options.quick, results);
        // For a single thread, whose time it is.
        if (threads == 1 && (!options.quick || options.sweeps)) {
            measure_sweeps(meter);
        }
        if (options.sweeps) {
            continue;
        }
        for (const double megabytes : {0.25, 4.0, 256.0}) {
            meter.add(fmt::format("bandwidth over {:g} MB (triad)", megabytes),
                      meter.bandwidth(megabytes * 1e6), "GB/s");
        }
        measure_parts(meter);
        if (threads == options.threads.front()) {
            measure_peers(meter);
        }
        measure_scaling(meter);
        measure_scene(meter);
        if (!options.quick) {
            measure_whole_scenes(meter);
        }
    }
    if (options.json) {
        std::cout << as_json(results).dump(2) << std::endl;
    } else {
        print_table(results, options.threads);
    }
    return 0;
}

}  // namespace eti::bench
