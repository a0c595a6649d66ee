// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/calibration/point_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/math/units.hpp"
#include "common/scenario/yaml_map.hpp"

namespace eti::devices {

namespace {

constexpr Range coordinate_range{-5000.0f, 5000.0f, millimetre};

}  // namespace

std::vector<PointPair> load_points(const std::filesystem::path& file, bool measured) {
    YamlMap map = YamlMap::parse(read_text_file(file), file.string());
    std::vector<PointPair> out;
    for (YamlMap& entry : map.list("points")) {
        PointPair pair;
        pair.name = entry.name("name", fmt::format("{}", out.size() + 1));
        for (const char* key : {"patient_mm", "device_mm"}) {
            if (!entry.has(key) && (measured || std::string_view(key) == "patient_mm")) {
                entry.refuse(key, "nothing", "three numbers in millimetres");
            }
        }
        pair.patient = entry.vector("patient_mm", coordinate_range).cast<double>();
        pair.device = entry.vector("device_mm", coordinate_range).cast<double>();
        entry.finish();
        out.push_back(pair);
    }
    map.finish();
    if (out.empty()) {
        map.refuse("points", "no points",
                   "a list of name, patient_mm" + std::string(measured ? ", device_mm" : ""));
    }
    return out;
}

std::vector<Eigen::Isometry3d> load_poses(const std::filesystem::path& file) {
    std::istringstream lines(read_text_file(file));
    std::vector<Eigen::Isometry3d> out;
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        std::ranges::replace(line, ',', ' ');
        if (line.find_first_not_of(" \t\r") == std::string::npos || line.starts_with('#')) {
            continue;
        }
        std::istringstream fields(line);
        double x = 0, y = 0, z = 0, qw = 0, qx = 0, qy = 0, qz = 0;
        std::string more;
        const bool seven =
            static_cast<bool>(fields >> x >> y >> z >> qw >> qx >> qy >> qz) && !(fields >> more);
        const Eigen::Quaterniond turn(qw, qx, qy, qz);
        if (!seven || !(std::abs(turn.norm() - 1.0) < 1e-2)) {
            throw InputError(
                fmt::format("{}:{}: found '{}', expected x y z [mm] and a unit quaternion w x y z",
                            file.string(), number, line.substr(0, 60)));
        }
        out.push_back(Eigen::Translation3d(1e-3 * Eigen::Vector3d(x, y, z)) * turn.normalized());
    }
    return out;
}

}  // namespace eti::devices
