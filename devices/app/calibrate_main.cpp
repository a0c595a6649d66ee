// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/spdlog.h>

#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/math/units.hpp"
#include "common/process/progress_bar.hpp"
#include "common/scenario/data_file.hpp"
#include "devices/app/program.hpp"
#include "devices/app/sampling.hpp"
#include "devices/calibration/point_file.hpp"
#include "devices/calibration/trials.hpp"
#include "devices/parts/parts.hpp"

namespace eti::devices {
namespace {

using nlohmann::ordered_json;

struct CalibrateOptions {
    ProgramOptions device;
    std::string points;  // points to touch
    std::string pairs;   // already measured
    std::string poses;   // of a pivot, already measured
    std::string pivot;   // result of an earlier pivot
    std::string tool = "laryngoscope";
    std::string blade = "miller_1";
    std::string out = "calibration.yaml";
    double seconds = 15.0;
    int trials = 1000;
    std::uint64_t seed = 1;
    bool json = false;
};

constexpr std::chrono::milliseconds poll{5};
constexpr int samples_per_touch = 60;

/// Calibration interrupted before enough was measured.
struct Interrupted : std::runtime_error {
    Interrupted() : std::runtime_error("interrupted; nothing was written") {}
};

RigidTransform single(const Eigen::Isometry3d& pose) {
    return {Quatf(Eigen::Quaterniond(pose.linear()).cast<float>()), pose.translation().cast<float>()};
}

Eigen::Isometry3d twice(const RigidTransform& pose) {
    return Eigen::Translation3d(pose.translation.cast<double>()) * pose.rotation.cast<double>().normalized();
}

/// Orientation of the tool on a device's moving part, as the printed parts hold it: the handle along a stylus
/// (its z), the tube along a magnetic sensor's cable (its x).
Quatf mounting(const std::string& device) {
    return device == "trakstar" ? quaternion_from({0.0f, 90.0f * degree, 0.0f})
                                : quaternion_from({90.0f * degree, 0.0f, 0.0f});
}

/// The point that rests in a dimple, tool frame: the ball at the printed blade's tip, or the tube's tip.
Vec3f tip_of(const CalibrateOptions& options) {
    if (options.tool == "tube") {
        const Tube tube;
        const float turn = tube.grip_from_tip / tube.curve_radius;
        return {0.0f, tube.curve_radius * (1.0f - std::cos(turn)), tube.curve_radius * std::sin(turn)};
    }
    return make_laryngoscope(options.blade == "miller_0" ? Blade::miller_0 : Blade::miller_1).tip() -
           tip_ball_radius * Vec3f::UnitZ();
}

/// Opens the device and reads it.
Sampling open(const CalibrateOptions& options) {
    SensorSetup setup;
    setup.source = options.device.source;
    setup.library = options.device.library;
    return Sampling(find_driver(options.device.device, DeviceRole::tool).open(setup));
}

void explain(Sampling& sampling) {
    const std::string fault = sampling.watch().fault();
    if (sampling.watch().health().lost && !fault.empty()) {
        spdlog::warn("connection to the device lost: {}", fault);
    }
}

/// Mean position of the tip over a quarter of a second, device frame.
Eigen::Vector3d touch(Sampling& sampling, const Eigen::Vector3d& tip) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Reading reading;
    for (int got = 0, tried = 0; got < samples_per_touch; ++tried) {
        std::this_thread::sleep_for(poll);
        sampling.watch().poll_events();
        if (sampling.newest(reading)) {
            sum += twice(reading.motion.pose) * tip;
            ++got;
        } else if (stop_requested()) {
            throw Interrupted{};
        } else if (tried % 400 == 399) {
            explain(sampling);
        }
    }
    return sum / samples_per_touch;
}

/// Touches the named points in turn and reports after each how well they agree.
std::vector<PointPair> touch_all(const CalibrateOptions& options, const Eigen::Vector3d& tip) {
    std::vector<PointPair> pairs = load_points(options.points, false);
    Sampling sampling = open(options);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        std::cerr << fmt::format("{}/{}  place the tip on '{}' and press Enter: ", i + 1, pairs.size(),
                                 pairs[i].name)
                  << std::flush;
        std::string line;
        if (!std::getline(std::cin, line) || stop_requested()) {
            throw Interrupted{};
        }
        pairs[i].device = touch(sampling, tip);
        if (i >= 3) {
            try {
                const RigidFit fit = fit_robustly(std::span(pairs).first(i + 1));
                std::cerr << fmt::format("      residual {:.2f} mm, all so far {:.2f} mm\n",
                                         1e3 * fit.residual[i], 1e3 * fit.fiducial_error);
            } catch (const CalibrationError& error) {
                std::cerr << "      " << error.what() << '\n';
            }
        }
    }
    return pairs;
}

/// Fits the touched points, writes the file and reports the quality.
int conclude(const CalibrateOptions& options, Calibration out, const std::vector<PointPair>& pairs) {
    out.device = options.device.device;
    out.date = utc_now();
    const RigidFit fit = fit_robustly(pairs);
    out.to_patient = single(fit.transform);
    out.error = fit.fiducial_error;
    out.left_out_error = fit.left_out_error;
    ordered_json points = ordered_json::array();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        out.points += fit.used[i] ? 1 : 0;
        points.push_back({{"name", pairs[i].name},
                          {"residual_mm", 1e3 * fit.residual[i]},
                          {"used", static_cast<bool>(fit.used[i])}});
        if (!fit.used[i]) {
            spdlog::warn("point '{}' deviates by {:.1f} mm and was excluded; touch it again if possible",
                         pairs[i].name, 1e3 * fit.residual[i]);
        }
    }
    if (!fit.advice.empty()) {
        spdlog::warn("to improve the result, {}", fit.advice);
    }
    if (fit.handedness_ambiguous) {
        spdlog::warn(
            "the points lie in one plane, so a device with mirrored axes would fit as well; touch more "
            "points, {:.0f} mm or more out of it",
            3e3 * FitSettings().outlier);
    }
    save_calibration(out, options.out);
    spdlog::info("{}: {} points, error {:.2f} mm, leave-one-out {:.2f} mm", options.out, out.points,
                 1e3 * out.error, 1e3 * out.left_out_error);
    print_json(options.json, {{"file", options.out},
                              {"points", points},
                              {"error_mm", 1e3 * out.error},
                              {"left_out_error_mm", 1e3 * out.left_out_error},
                              {"handedness_open", fit.handedness_ambiguous},
                              {"advice", fit.advice}});
    return 0;
}

int register_device(const CalibrateOptions& options) {
    Calibration out;
    out.device = options.device.device;
    out.tool = {mounting(out.device), Vec3f::Zero()};
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();
    if (!options.pivot.empty()) {
        const Calibration pivot = load_calibration(options.pivot);
        if (pivot.registered || pivot.device != out.device) {
            throw InputError(fmt::format(
                "--pivot {}: is {} of device '{}', expected a pivot of '{}'; run "
                "eti-calibrate pivot for it",
                options.pivot, pivot.registered ? "a registration" : "a pivot", pivot.device, out.device));
        }
        out.tool = pivot.tool;
        tip = (pivot.tool * tip_of(options)).cast<double>();
    }
    const std::vector<PointPair> pairs =
        options.pairs.empty() ? touch_all(options, tip) : load_points(options.pairs, true);
    return conclude(options, out, pairs);
}

/// Registers a simulated device: its frame is the patient's, so the deviation from identity is the error.
int register_simulated(const CalibrateOptions& options) {
    const SensorNoise& noise = sensor_noise_table().front();
    Random random(options.seed);
    const auto board = load_points(options.points, false);
    spdlog::info("points touched with the noise of a {}: {}", noise.device, noise.source);
    return conclude(options, {}, simulate_touches(board, noise, Eigen::Isometry3d::Identity(), random));
}

std::vector<Eigen::Isometry3d> swing(const CalibrateOptions& options) {
    Sampling sampling = open(options);
    std::vector<Eigen::Isometry3d> poses;
    spdlog::info("place the tip in a dimple and swing the handle in all directions for {:.0f} s",
                 options.seconds);
    Reading reading;
    ProgressBar bar;
    for (double left = options.seconds; left > 0.0; left -= 1e-3 * static_cast<double>(poll.count())) {
        if (stop_requested()) {
            throw Interrupted{};
        }
        std::this_thread::sleep_for(poll);
        sampling.watch().poll_events();
        if (sampling.newest(reading)) {
            poses.push_back(twice(reading.motion.pose));
        }
        bar.draw(static_cast<float>(1.0 - left / options.seconds), fmt::format("{} poses", poses.size()));
    }
    bar.clear();
    explain(sampling);
    return poses;
}

int pivot(const CalibrateOptions& options) {
    const auto poses = options.poses.empty() ? swing(options) : load_poses(options.poses);
    const PivotFit fit = fit_pivot(poses);
    Calibration out;
    out.registered = false;
    out.device = options.device.device;
    out.date = utc_now();
    out.points = static_cast<int>(poses.size());
    out.error = fit.error;
    const Quatf turn = mounting(out.device);
    out.tool = {turn, fit.tip.cast<float>() - turn * tip_of(options)};
    save_calibration(out, options.out);
    const Eigen::Vector3d mm = 1e3 * fit.tip;
    spdlog::info(
        "{}: the tip lies at ({:.1f}, {:.1f}, {:.1f}) mm in the sensor's frame, {:.2f} mm RMS over {} poses",
        options.out, mm.x(), mm.y(), mm.z(), 1e3 * fit.error, poses.size());
    print_json(options.json, {{"file", options.out},
                              {"tip_mm", {mm.x(), mm.y(), mm.z()}},
                              {"error_mm", 1e3 * fit.error},
                              {"poses", poses.size()}});
    return 0;
}

int simulate(const CalibrateOptions& options) {
    if (!options.device.device.empty()) {
        return register_simulated(options);
    }
    const auto board = load_points(options.points, false);
    ordered_json rows = ordered_json::array();
    if (!options.json) {
        std::cout << fmt::format("{:<10}{:>10}{:>12}{:>10}{:>10}{:>10}  noise\n", "device", "outliers",
                                 "median mm", "95 % mm", "worst mm", "refused");
    }
    for (const SensorNoise& noise : sensor_noise_table()) {
        for (const bool outliers : {false, true}) {
            if (stop_requested()) {
                throw Interrupted{};
            }
            const TrialResult r = simulate_calibrations(board, noise, options.trials, outliers, options.seed);
            rows.push_back({{"device", noise.device},
                            {"outliers", outliers},
                            {"trials", options.trials},
                            {"median_mm", 1e3 * r.median},
                            {"percentile_95_mm", 1e3 * r.percentile_95},
                            {"worst_mm", 1e3 * r.worst},
                            {"refused", r.refused},
                            {"noise", noise.source}});
            if (!options.json) {
                std::cout << fmt::format("{:<10}{:>10}{:>12.2f}{:>10.2f}{:>10.2f}{:>10}  {}\n", noise.device,
                                         outliers ? "yes" : "no", 1e3 * r.median, 1e3 * r.percentile_95,
                                         1e3 * r.worst, r.refused, noise.source);
            }
        }
    }
    print_json(options.json, rows);
    return 0;
}

}  // namespace
}  // namespace eti::devices

int main(int argc, char** argv) {
    using namespace eti::devices;
    CalibrateOptions options;
    eti::CommandLine app(
        "Calibrates the pose of a device relative to the patient, and the position of a tool's tip on it.",
        "eti-calibrate");
    app.require_subcommand(1);
    const auto common = [&](eti::CommandLine command) {
        add_device_options(command, options.device, DeviceRole::tool);
        command.add_option("--tool", options.tool, "Tool that the device holds")
            .capture_default_str()
            .one_of({"laryngoscope", "tube"});
        command.add_option("--blade", options.blade, "Blade size of the laryngoscope")
            .capture_default_str()
            .one_of({"miller_0", "miller_1"});
        command.add_option("--out", options.out, "File to write").capture_default_str();
        command.add_flag("--json", options.json, "Print one JSON object");
    };
    eti::CommandLine points =
        app.add_subcommand("register", "Register by touching points with known positions");
    common(points);
    points
        .add_option("--points", options.points,
                    "Positions of the points, by name or path (board: the printed board)")
        .capture_default_str();
    points.add_option("--pairs", options.pairs, "Points measured earlier, instead of touching them now");
    points.add_option("--pivot", options.pivot,
                      "Result of 'pivot', to touch with the tool's tip instead of the device's");
    eti::CommandLine turn = app.add_subcommand("pivot", "Locate the tip by swinging the tool about it");
    common(turn);
    turn.add_option("--poses", options.poses,
                    "Poses measured earlier: x y z [mm] and quaternion w x y z per line");
    turn.add_number("--seconds", options.seconds, "Duration of the swing", {1.0, 600.0, "s"})
        .capture_default_str();
    eti::CommandLine trial =
        app.add_subcommand("simulate", "Predict the error of each device by seeded trials");
    trial.add_option("--points", options.points, "Points to touch, by name or path");
    trial.add_number("--trials", options.trials, "Number of trials per device", {1, 1000000})
        .capture_default_str();
    trial.add_number("--seed", options.seed, "Seed of the trials", {0}).capture_default_str();
    trial
        .add_option("--device", options.device.device,
                    "Instead of a table, write the calibration of one trial for this simulated device")
        .one_of({"simulated", "scripted"});
    trial.add_option("--out", options.out, "File for that calibration").capture_default_str();
    trial.add_flag("--json", options.json, "Print the result as JSON");
    const auto work = [&] {
        options.points =
            eti::find_data_file(options.points.empty() ? "board" : options.points, "calibration").string();
        return points.parsed() ? register_device(options)
               : turn.parsed() ? pivot(options)
                               : simulate(options);
    };
    return eti::run_program(app, argc, argv, work, device_signals);
}
