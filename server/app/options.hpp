// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "server/app/run/quality.hpp"

namespace eti::app {

/// Options of eti-server's command line.
struct Options {
    std::vector<std::string> scenarios{"term"};  ///< run one after another; never empty
    std::string operator_name;                   ///< empty: tool poses come over the bus
    std::optional<float> skill;                  ///< overrides the operator file's
    std::optional<int> attempts;                 ///< overrides the operator file's
    std::filesystem::path record;                ///< empty: no session file
    std::string participant;                     ///< pseudonym, for the session file
    bus::Options bus{.name = std::string(bus::server_name)};
    bool fast = false;  ///< run as fast as possible instead of in real time
    bool with_bus = true;
    bool json = false;
    bool finish_after_attempt = false;
    bool loop = false;  ///< restarts the replay, or the operator's script, at its end
    std::optional<std::uint64_t> steps;
    double duration = 0.0;  ///< [s] of simulation time; 0: no limit
    std::optional<std::uint64_t> seed;
    std::filesystem::path resimulate;   ///< session file whose inputs are simulated again; empty: none
    std::vector<std::string> settings;  ///< KEY=VALUE overrides for that
    struct Replay {
        std::filesystem::path file;  ///< session file to replay; empty: none
        double speed = 1.0;
        double from = 0.0;         ///< [s]
        std::optional<double> to;  ///< [s]; default: to the end
        bool pause = false;        ///< start paused
    } replay;
    int threads = 0;  ///< 0: one per core
    Quality quality = Quality::automatic;
};

/// Parses the command line. Returns an exit code if there is nothing to run (help, version, error).
[[nodiscard]] std::optional<int> parse(int argc, char** argv, Options& options);

}  // namespace eti::app
