// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "server/app/options.hpp"
#include "server/app/server.hpp"

int main(int argc, char** argv) {
    // Standard output belongs to the result.
    spdlog::set_default_logger(spdlog::stderr_color_mt("eti-server"));
    eti::app::Options options;
    if (const auto code = eti::app::parse(argc, argv, options)) {
        return *code;
    }
    return eti::app::run_server(options);
}
