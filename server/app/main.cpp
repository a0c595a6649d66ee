// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/program.hpp"
#include "server/app/options.hpp"
#include "server/app/run/server.hpp"

int main(int argc, char** argv) {
    eti::app::Options options;
    return eti::run_program(
        "eti-server", [&] { return eti::app::parse(argc, argv, options); },
        [&] { return eti::app::run_server(options); });
}
