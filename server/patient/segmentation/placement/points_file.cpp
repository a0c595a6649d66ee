// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/placement/points_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/model/landmark.hpp"
#include "common/process/escaped.hpp"
#include "server/patient/imaging/bytes.hpp"
#include "server/patient/imaging/volume.hpp"

namespace eti::segmentation {

namespace {

constexpr std::array<std::string_view, 5> seed_names = {"mandible", "skull", "spine", "tongue", "mouth"};

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& found,
                         const std::string& expected, const std::string& remedy) {
    throw imaging::VolumeError(
        fmt::format("{}: landmarks: {}; expected {}. Remedy: {}.", file.string(), found, expected, remedy));
}

/// A code, or code, scheme and meaning (DICOM's coded entry, as newer versions of Slicer write).
std::string unit_of(const nlohmann::json& markup) {
    const auto unit = markup.find("coordinateUnits");
    if (unit == markup.end()) {
        return "mm";
    }
    return unit->is_array() && !unit->empty() ? unit->front().get<std::string>() : unit->get<std::string>();
}

}  // namespace

bool is_known_point(const std::string& name) {
    return std::find(seed_names.begin(), seed_names.end(), name) != seed_names.end() ||
           find_landmark(name).has_value();
}

Points read_points(const std::filesystem::path& file, std::vector<std::string>& remarks) {
    constexpr std::size_t longest = 1 << 20;
    const imaging::Bytes text = imaging::read_bytes(file, longest);
    Points points;
    try {
        const auto root = nlohmann::json::parse(text.begin(), text.end());
        for (const auto& markup : root.at("markups")) {
            const std::string system = markup.value("coordinateSystem", "LPS");
            if (system != "LPS" && system != "RAS") {
                refuse(file, fmt::format("the coordinate system is '{}'", system), "LPS or RAS",
                       "save it in one of these");
            }
            if (const std::string unit = unit_of(markup); unit != "mm") {
                refuse(file, fmt::format("the unit is '{}'", unit), "mm", "save it in millimetres");
            }
            const double sign = system == "LPS" ? 1.0 : -1.0;
            for (const auto& point : markup.at("controlPoints")) {
                const std::string name = point.at("label");
                if (!is_known_point(name)) {
                    refuse(file, fmt::format("a point is named '{}'", name.substr(0, 60)),
                           "mandible, skull, spine, tongue, mouth or a landmark's name such as tongue_tip",
                           "rename it");
                }
                // A point that was named in Slicer, but not placed, has a position that means nothing.
                if (const std::string status = point.value("positionStatus", "defined");
                    status != "defined") {
                    remarks.push_back(fmt::format("{}: ignored a point '{}' whose position is {}",
                                                  file.string(), name, escaped(status, max_shown_bytes)));
                    continue;
                }
                const auto at = point.at("position").get<std::array<double, 3>>();
                const Vec3d place = 1e-3 * Vec3d(sign * at[0], sign * at[1], at[2]);
                if (!place.allFinite() || place.norm() > 100.0) {
                    refuse(file, fmt::format("point '{}' lies at {}, {}, {} mm", name, at[0], at[1], at[2]),
                           "a position in the volume", "set it again");
                }
                points[name].push_back(place);
            }
        }
    } catch (const nlohmann::json::exception& error) {
        refuse(file, error.what(), "points as 3D Slicer saves them (*.mrk.json)",
               "save them with 3D Slicer's Markups, or see docs/anatomy/segment.md for an example");
    }
    return points;
}

std::string encode_points(const Points& points) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    int id = 0;
    for (const auto& [name, places] : points) {
        for (const Vec3d& place : places) {
            const auto rounded = [](double metres) { return std::round(metres * 1e6) / 1e3; };
            list.push_back({{"id", std::to_string(++id)},
                            {"label", name},
                            {"position", {rounded(place.x()), rounded(place.y()), rounded(place.z())}}});
        }
    }
    const nlohmann::ordered_json root = {
        {"@schema",
         "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/"
         "markups-schema-v1.0.3.json#"},
        {"markups",
         {{{"type", "Fiducial"},
           {"coordinateSystem", "LPS"},
           {"coordinateUnits", "mm"},
           {"controlPoints", list}}}}};
    return root.dump(2) + "\n";
}

}  // namespace eti::segmentation
