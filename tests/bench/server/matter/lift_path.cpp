// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/matter/lift_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>

#include "common/model/pace.hpp"
#include "server/app/run/local_operator.hpp"
#include "server/app/run/simulation.hpp"

namespace eti::bench {

namespace {

constexpr std::size_t steps_per_pose = 6;  // 30 poses a second
constexpr double longest_lift = 15.0;      // [s] by which the expert has seen the glottis
constexpr double view_settled = 1.5;       // [s] without a better view, after which none is expected
constexpr int poses_at_rest = 45;          // at the end, until tissue has come to rest: 1.5 s

}  // namespace

LiftPath record_lift(const Scenario& scenario, const patient::Patient& patient) {
    const OperatorScript script = load_operator(find_data_file("expert", "operators"));
    scene::Inputs inputs = app::parked_inputs(scenario, patient);
    app::Simulation simulation(scenario, patient, inputs);
    app::LocalOperator hands(script, simulation.scope(), scenario.tube, scenario.seed ^ script.seed,
                             simulation.observation());
    const RigidTransform tube = inputs.tube_grip;
    hands.apply_to(inputs);
    inputs.tube_grip = tube;
    simulation.scene().reset(inputs);
    LiftPath path = {inputs.laryngoscope};
    std::size_t best = 0;
    float seen = 0.0f;
    double seen_at = longest_lift;
    while (simulation.time() < std::min(longest_lift, seen_at + view_settled)) {
        hands.advance(simulation.observation(), simulation.snapshot());
        hands.apply_to(inputs);
        inputs.tube_grip = tube;
        simulation.step(inputs, std::nullopt);
        path.push_back(inputs.laryngoscope);
        const float opening = simulation.metrics().live().measures.glottic_opening_percent;
        if (opening > seen) {
            seen = opening;
            seen_at = simulation.time();
            best = path.size();
        }
    }
    if (best == 0) {
        throw std::runtime_error("the expert never saw the glottis: there is no lift to record");
    }
    path.resize(best);
    path.insert(path.end(), steps_per_pose - 1, path.back());  // so that its last pose is written
    return path;
}

void write_path(const LiftPath& path, const std::filesystem::path& file) {
    std::ofstream out(file);
    out << "time_s,x,y,z,qw,qx,qy,qz\n";
    for (std::size_t k = 0; k < path.size(); k += steps_per_pose) {
        const Vec3f& x = path[k].translation;
        const Quatf& q = path[k].rotation;
        out << fmt::format("{:.4f},{:.7f},{:.7f},{:.7f},{:.6f},{:.6f},{:.6f},{:.6f}\n",
                           static_cast<double>(k) / steps_per_second, x.x(), x.y(), x.z(), q.w(), q.x(),
                           q.y(), q.z());
    }
    if (!out.flush()) {
        throw std::runtime_error("cannot write " + file.string());
    }
}

LiftPath read_path(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    LiftPath poses;
    while (std::getline(in, line)) {
        std::array<float, 8> v{};
        std::size_t at = 0;
        for (float& number : v) {
            const std::size_t end = std::min(line.find(',', at), line.size());
            number = std::stof(line.substr(at, end - at));
            at = end + 1;
        }
        poses.push_back({Quatf(v[4], v[5], v[6], v[7]).normalized(), Vec3f(v[1], v[2], v[3])});
    }
    if (poses.empty()) {
        throw std::runtime_error("no poses in " + file.string() + "; record the path with --record");
    }
    poses.insert(poses.end(), poses_at_rest, poses.back());
    LiftPath path;
    for (std::size_t k = 0; k + 1 < poses.size(); ++k) {
        for (std::size_t n = 0; n < steps_per_pose; ++n) {
            const float share = static_cast<float>(n) / static_cast<float>(steps_per_pose);
            path.push_back(
                {poses[k].rotation.slerp(share, poses[k + 1].rotation),
                 poses[k].translation + share * (poses[k + 1].translation - poses[k].translation)});
        }
    }
    path.push_back(poses.back());
    return path;
}

}  // namespace eti::bench
