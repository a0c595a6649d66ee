// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "common/bus/bus.hpp"

namespace eti::bench {

using Clock = std::chrono::steady_clock;

/// One endpoint of a measurement: a process that bench.py starts on one of its hosts. Each part returns its
/// output.
struct PartOptions {
    bus::Options bus{};
    double seconds = 5.0;           ///< duration of the measurement
    double wait_s = 20.0;           ///< timeout for the other endpoint
    double stay_s = 0.0;            ///< keeps running this long after its report, so that it can be killed
    double rate = 1000.0;           ///< [Hz]
    bool drive = false;             ///< a join counts once the server answers a pose
    bool every_state = false;       ///< 90 Hz, else 30 Hz
    std::filesystem::path keep{};   ///< file for the received states
    std::filesystem::path other{};  ///< such a file of another reader, whose drawing error is measured
};

/// Joins a session: times [ms] from process start to each milestone.
[[nodiscard]] nlohmann::json join(const PartOptions& options);
/// Publishes poses of the laryngoscope.
[[nodiscard]] nlohmann::json write_poses(const PartOptions& options);
/// Reads them; their age on arrival [us].
[[nodiscard]] nlohmann::json read_poses(const PartOptions& options);
/// Follows the scene as a client does, without drawing; reports when it has the scene, and at its end. With
/// `other`, follows until that file exists, and reports the drawing error of a client that lacks the samples
/// missed by the other reader.
[[nodiscard]] nlohmann::json read_states(const PartOptions& options);
/// Time since this process started [ms].
[[nodiscard]] double since_start_ms();

}  // namespace eti::bench
