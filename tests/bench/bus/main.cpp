// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// eti-bench-bus: cost of the bus, and its behaviour over poor links. The benches themselves are in bench.py
// beside this file, which starts processes on hosts; those processes run this program, too.
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "common/bus/command_line.hpp"
#include "common/process/program.hpp"
#include "tests/bench/bus/parts.hpp"

namespace {

using namespace eti::bench;

int run_script(int argc, char** argv) {
    const std::string programs = std::filesystem::read_symlink("/proc/self/exe").parent_path().string();
    std::vector<std::string> words{"python3", "-B", ETI_BUS_BENCH, "--bin", programs};
    bool named = false;
    for (int i = 1; i < argc; ++i) {
        // The launcher passes the bench's own name.
        if (!named && std::string_view(argv[i]) == "bus") {
            named = true;
        } else {
            words.emplace_back(argv[i]);
        }
    }
    std::vector<char*> pointers;
    for (std::string& word : words) {
        pointers.push_back(word.data());
    }
    pointers.push_back(nullptr);
    ::execvp(pointers[0], pointers.data());
    fmt::print(stderr, "eti-bench-bus: cannot run python3: {}; run deploy/setup.sh\n", std::strerror(errno));
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    struct Part {
        const char* name;
        const char* help;
        nlohmann::json (*run)(const PartOptions&);
    };
    constexpr Part parts[] = {{"join", "Join a session", join},
                              {"write-poses", "Publish poses", write_poses},
                              {"read-poses", "Read poses", read_poses},
                              {"read-states", "Follow the scene", read_states}};
    const bool part_asked = argc > 1 && std::ranges::any_of(parts, [&](const Part& part) {
                                return std::string_view(argv[1]) == part.name;
                            });
    if (!part_asked) {
        return run_script(argc, argv);
    }
    eti::CommandLine app("One end of a measurement of the bus; prints a JSON object", "eti-bench-bus");
    app.require_subcommand(1);
    PartOptions options;
    options.bus.name = "eti-bench-bus";
    nlohmann::json (*run)(const PartOptions&) = nullptr;
    for (const Part& part : parts) {
        eti::CommandLine sub = app.add_subcommand(part.name, part.help);
        eti::bus::add_options(sub, options.bus);
        const eti::NumberLimits<double> time{0.0, 1e6, "s"};
        sub.add_number("--seconds", options.seconds, "Duration of the measurement", time)
            .capture_default_str();
        sub.add_number("--wait", options.wait_s, "Longest wait for the other end", time)
            .capture_default_str();
        sub.add_number("--stay", options.stay_s, "Continue for this time after the report", time);
        sub.add_number("--rate", options.rate, "Rate of poses", {1.0, 10e3, "Hz"});
        sub.add_flag("--drive", options.drive, "Count a join when the server answers a pose");
        sub.add_flag("--every-state", options.every_state, "Receive shapes at 90 Hz instead of 30 Hz");
        sub.add_option("--keep", options.keep, "Write the received states to this file");
        sub.add_option("--other", options.other,
                       "Such a file of another reader: report its rendering errors");
        sub.callback([&run, &part] { run = part.run; });
    }
    return eti::run_program(app, argc, argv, [&] {
        (void)since_start_ms();
        const nlohmann::json out = run(options);
        if (!out.is_null()) {
            fmt::print("{}\n", out.dump());
        }
        return 0;
    });
}
