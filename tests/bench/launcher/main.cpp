// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// eti-bench launches the bench program that implements a command, with the same arguments.
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "common/process/escaped.hpp"

namespace {

struct Command {
    const char* name;
    const char* program;
    const char* description;
};

constexpr std::array<Command, 11> commands = {{
    {"speed", "eti-bench-physics", "Cost of the solver's parts"},
    {"accuracy", "eti-bench-physics", "Error against cost of every method, in cases with a reference"},
    {"calibration", "eti-bench-physics", "Measured modulus of bodies of clusters over the input modulus"},
    {"stability", "eti-bench-physics", "Where every method survives, recovers or fails"},
    {"sufficiency", "eti-bench-physics", "Outcome of an intubation over the resolution of the model"},
    {"sleep", "eti-bench-physics", "Effect and savings of sleeping tissue"},
    {"matter", "eti-bench-physics", "Volume, forces and rest of the tissue in a lift of the blade"},
    {"merge", "eti-bench-physics", "Merge the tables of a sweep's shards (--shard I/N)"},
    {"haptics", "eti-bench-devices", "Stable stiffness, timing and force laws of the haptic loop"},
    {"render", "eti-bench-render", "Image quality at moments of attempts, measured against goals"},
    {"bus", "eti-bench-bus", "Latency, joins, loss, observers and endurance of the bus"},
}};

void usage(std::FILE* to) {
    fmt::print(to,
               "Benchmarks of every part: charts and tables that decide the shipped settings.\n"
               "Usage: eti-bench [--threads N] COMMAND [OPTION...]; COMMAND --help lists its options\n");
    for (const Command& command : commands) {
        fmt::print(to, "  {:<12} {}\n", command.name, command.description);
    }
}

}  // namespace

int main(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
        const std::string_view argument = argv[i];
        for (const Command& command : commands) {
            if (argument != command.name) {
                continue;
            }
            std::error_code error;
            const auto program =
                std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / command.program;
            ::execv(program.c_str(), argv);
            fmt::print(
                stderr,
                "eti-bench: cannot run {}: {}. Build it: cmake --build build/release --target eti-bench\n",
                program.string(), std::strerror(errno));
            return 1;
        }
    }
    // None of the words is a known command: the first one determines the message.
    const std::string_view first = argc > 1 ? argv[1] : "";
    if (first == "--help" || first == "-h") {
        usage(stdout);
        return 0;
    }
    if (first == "--version") {
        fmt::print("{}\n", ETI_VERSION);
        return 0;
    }
    if (!first.empty()) {
        fmt::print(stderr, "eti-bench: '{}' is not a command\n", eti::escaped(first, eti::max_shown_bytes));
    }
    usage(stderr);
    return 2;
}
