// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/calibration/calibration_file.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <ctime>
#include <fstream>

#include "common/math/units.hpp"
#include "common/process/files/atomic_file_writer.hpp"
#include "common/process/files/file_kind.hpp"
#include "common/scenario/yaml_map.hpp"

namespace eti::devices {

namespace {

constexpr Range translation_range{-5000.0f, 5000.0f, millimetre};
constexpr Range degrees{-180.0f, 180.0f, degree};
constexpr Range errors{0.0f, 100.0f, millimetre};

constexpr std::array<std::string_view, 2> kinds = {"pivot", "registration"};

/// Writes a rotation as its rotation vector in degrees: three readable numbers that are always consistent.
std::string written(const RigidTransform& pose) {
    const Vec3f t = pose.translation / millimetre;
    const Vec3f r = rotation_vector(pose.rotation) / degree;
    return fmt::format(
        "\n  translation_mm: [{:.4f}, {:.4f}, {:.4f}]\n  rotation_vector_deg: [{:.5f}, {:.5f}, {:.5f}]\n",
        t.x(), t.y(), t.z(), r.x(), r.y(), r.z());
}

RigidTransform read(YamlMap& file, const std::string& key) {
    std::optional<YamlMap> map = file.map(key);
    if (!map) {
        file.refuse(key, "nothing", "translation_mm and rotation_vector_deg; write it with eti-calibrate");
    }
    const Vec3f translation = map->vector("translation_mm", translation_range);
    const RigidTransform pose{quaternion_from(map->vector("rotation_vector_deg", degrees)), translation};
    map->finish();
    return pose;
}

}  // namespace

std::string utc_now() {
    const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    std::tm parts{};
    ::gmtime_r(&now, &parts);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", parts.tm_year + 1900, parts.tm_mon + 1,
                       parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec);
}

void save_calibration(const Calibration& c, const std::filesystem::path& file) {
    if (const std::string kind = describe_blocking_entry(file); !kind.empty()) {
        throw InputError(
            fmt::format("{}: is {}, expected a file or a new name; choose another place with --out",
                        file.string(), kind));
    }
    const std::string text = fmt::format(
        "# Written by eti-calibrate; read with --calibration.\n"
        "kind: {}\ndevice: {}\ndate: {}\npoints: {}\nerror_mm: {:.3f}\nleft_out_error_mm: {:.3f}\n"
        "to_patient:{}tool:{}",
        kinds[c.registered ? 1 : 0], c.device, c.date, c.points, 1e3 * c.error, 1e3 * c.left_out_error,
        written(c.to_patient), written(c.tool));
    if (const std::string why = write_file_atomically(file, text); !why.empty()) {
        throw InputError(
            fmt::format("{}: cannot be written: {}; choose another place with --out", file.string(), why));
    }
}

Calibration load_calibration(const std::filesystem::path& file) {
    YamlMap map = YamlMap::parse(read_text_file(file), file.string());
    Calibration out;
    out.registered = map.choice("kind", 1, kinds) == 1;
    out.device = map.name("device", "");
    out.date = map.name("date", "undated");
    out.points = map.whole("points", 0, 0, 1'000'000);
    out.error = static_cast<double>(map.number("error_mm", 0.0f, errors));
    out.left_out_error = static_cast<double>(map.number("left_out_error_mm", 0.0f, errors));
    out.to_patient = read(map, "to_patient");
    out.tool = read(map, "tool");
    map.finish();
    return out;
}

}  // namespace eti::devices
