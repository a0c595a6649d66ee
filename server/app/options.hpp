// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace eti::app {

/// What eti-server was asked to do.
struct Options {
    std::vector<std::string> scenarios{"term"};  ///< one session after another; never empty
    std::string operator_name;                   ///< empty: the hands come over the bus
    std::optional<float> skill;                  ///< of that operator, instead of its file's
    std::optional<int> attempts;                 ///< the same
    std::filesystem::path record;                ///< empty: no session file
    std::string participant;                     ///< pseudonym, for the session file
    bus::Options bus{.name = std::string(bus::server_name)};
    bool fast = false;  ///< ignore the clock
    bool with_bus = true;
    bool json = false;
    bool finish_after_attempt = false;
    bool loop = false;  ///< the replay, or the operator's script, begins again at its end
    std::optional<std::uint64_t> steps;
    double duration = 0.0;  ///< [s] of simulation time; 0: no limit
    std::optional<std::uint64_t> seed;
    std::filesystem::path resimulate;   ///< a session file whose inputs run again; empty: none
    std::vector<std::string> settings;  ///< of what is set otherwise then, KEY=VALUE
    struct Replay {
        std::filesystem::path file;  ///< a session file that is shown again; empty: none
        double speed = 1.0;
        double from = 0.0;         ///< [s]
        std::optional<double> to;  ///< [s]; to its end
        bool pause = false;        ///< at the beginning
    } replay;
    int threads = 0;  ///< 0: as many as there are cores
};

/// Parses the command line. Returns an exit code when there is nothing to run (help, version, error).
[[nodiscard]] std::optional<int> parse(int argc, char** argv, Options& options);

}  // namespace eti::app
