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

/// One end of a measurement: a process that bench.py starts on one of its hosts. Each part returns what it
/// prints.
struct PartOptions {
    bus::Options bus{};
    double seconds = 5.0;           ///< how long it measures
    double wait_s = 20.0;           ///< how long it waits for the other end
    double stay_s = 0.0;            ///< how long it goes on after its report, so that it can be killed
    double rate = 1000.0;           ///< [Hz]
    bool drive = false;             ///< a join counts once the server answers a pose
    bool every_state = false;       ///< 90 Hz, else 30 Hz
    std::filesystem::path keep{};   ///< the states that arrived go into this file
    std::filesystem::path other{};  ///< such a file of another reader, whose drawn error is wanted
};

/// Joins a session: times [ms] since the process began to when it has this and that.
[[nodiscard]] nlohmann::json join(const PartOptions& options);
/// Publishes poses of the laryngoscope.
[[nodiscard]] nlohmann::json write_poses(const PartOptions& options);
/// Reads them; how old they arrive [us].
[[nodiscard]] nlohmann::json read_poses(const PartOptions& options);
/// Follows the scene as a client does, without drawing; reports when it has the scene, and at its end. With
/// `other` it follows until that file is there, and says what a client draws wrongly that lacks what the
/// other reader did not get.
[[nodiscard]] nlohmann::json read_states(const PartOptions& options);
/// Of this process's beginning until now [ms].
[[nodiscard]] double since_start_ms();

}  // namespace eti::bench
