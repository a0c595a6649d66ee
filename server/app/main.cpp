// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/log.hpp"
#include "server/app/options.hpp"
#include "server/app/run/server.hpp"

int main(int argc, char** argv) {
    eti::set_up_log("eti-server");
    eti::app::Options options;
    if (const auto code = eti::app::parse(argc, argv, options)) {
        return *code;
    }
    return eti::app::run_server(options);
}
