// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/matter/lift_path.hpp"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <stdexcept>
#include <string>

#include "common/model/pace.hpp"
#include "tests/bench/server/accuracy/lift_scene.hpp"

namespace eti::bench {

namespace {

constexpr std::size_t steps_per_pose = 6;  // 30 poses a second

}  // namespace

std::filesystem::path source_file(const std::filesystem::path& path) {
    // ROOT/build/PRESET/bin/PROGRAM
    return std::filesystem::read_symlink("/proc/self/exe").parent_path() / "../../.." / path;
}

LiftPath record_lift(const Scenario& scenario, const patient::Patient& patient) {
    LiftPath path;
    for (const scene::Inputs& inputs : lift_of(scenario, patient)) {
        path.push_back(inputs.laryngoscope);
    }
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
