// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/spdlog.h>

#include <functional>
#include <list>
#include <nlohmann/json.hpp>

#include "common/mesh/check.hpp"
#include "common/process/files/folder.hpp"
#include "common/scenario/data_file.hpp"
#include "devices/app/program.hpp"
#include "devices/calibration/point_file.hpp"
#include "devices/parts/parts.hpp"

int main(int argc, char** argv) {
    using namespace eti;
    using namespace eti::devices;
    PartSettings settings;
    std::filesystem::path out = "parts";
    float tube_inner_mm = 3.0f;
    bool json = false;
    CommandLine app(
        "Writes 3D-printable parts from the models of the tools: laryngoscopes for a stylus, a connector for "
        "a magnetic sensor, the board for eti-calibrate. Binary STL, millimetres.",
        "eti-parts");
    app.add_option("--out", out, "Output folder").capture_default_str();
    std::list<std::pair<float*, float>> typed;  // a setting [m] and its given value [mm]
    const auto millimetres = [&](const char* name, float& value, const char* text, float low, float high) {
        typed.push_back({&value, 1e3f * value});
        app.add_number(name, typed.back().second, text, {low, high, "mm"}).capture_default_str();
    };
    millimetres("--stylus-diameter-mm", settings.stylus_diameter, "Diameter of the stylus in the handle",
                2.0f, 20.0f);
    millimetres("--stylus-depth-mm", settings.stylus_depth, "Depth of the bore", 5.0f, 80.0f);
    millimetres("--sensor-diameter-mm", settings.sensor_diameter, "Diameter of the magnetic sensor", 0.5f,
                10.0f);
    millimetres("--sensor-length-mm", settings.sensor_length, "Depth of the bore", 5.0f, 40.0f);
    millimetres("--clearance-mm", settings.clearance, "Clearance of every bore; depends on the printer", 0.0f,
                1.0f);
    app.add_number("--tube-inner-diameter-mm", tube_inner_mm, "Inner diameter of the tube",
                   {2.0f, 6.0f, "mm"})
        .capture_default_str();
    app.add_flag("--json", json, "Print one JSON array");
    const auto work = [&] {
        for (const auto& [setting, mm] : typed) {
            *setting = 1e-3f * mm;
        }
        Tube tube;
        tube.inner_diameter = 1e-3f * tube_inner_mm;
        tube.outer_diameter = outer_diameter_of(tube.inner_diameter);
        const auto board = [&] {
            std::vector<Eigen::Vector3d> points;
            for (const PointPair& pair : load_points(find_data_file("board", "calibration"), false)) {
                points.push_back(pair.patient);
            }
            return board_part(points, settings);
        };
        const std::vector<std::pair<std::string, std::function<TriangleMesh()>>> parts = {
            {"laryngoscope_miller_0",
             [&] { return laryngoscope_part(make_laryngoscope(Blade::miller_0), settings); }},
            {"laryngoscope_miller_1",
             [&] { return laryngoscope_part(make_laryngoscope(Blade::miller_1), settings); }},
            {"tube_connector", [&] { return tube_connector_part(tube, settings); }},
            {"calibration_board", board},
        };
        make_folder(out);
        nlohmann::ordered_json rows = nlohmann::ordered_json::array();
        for (const auto& [name, make] : parts) {
            if (stop_requested()) {
                spdlog::info("interrupted");
                return 1;
            }
            const TriangleMesh mesh = make();
            const MeshReport report = check(mesh);
            if (!report.is_valid()) {
                throw std::runtime_error(name + ": not a closed surface: " + report.describe());
            }
            const std::filesystem::path file = out / (name + ".stl");
            write_stl(mesh, file);
            spdlog::info("{}: {} triangles, {:.1f} cm3, closed", file.string(), report.triangles,
                         1e6 * report.volume);
            rows.push_back({{"file", file.string()},
                            {"triangles", report.triangles},
                            {"volume_cm3", 1e6 * report.volume}});
        }
        print_json(json, rows);
        return 0;
    };
    return run_program(app, argc, argv, work, device_signals);
}
