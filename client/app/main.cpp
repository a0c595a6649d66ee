// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/spdlog.h>

#include <exception>
#include <iostream>

#include "client/app/headset/headset.hpp"
#include "client/app/offscreen/offscreen.hpp"
#include "client/app/options.hpp"
#include "client/app/window/windowed.hpp"
#include "common/process/log.hpp"
#include "common/process/stop_signal.hpp"

int main(int argc, char** argv) {
    using namespace eti::client;
    eti::set_up_log("eti-client");
    Options options;
    if (const auto status = parse(argc, argv, options)) {
        return *status;
    }
    eti::catch_stop_signals({.second_ends = true});
    try {
        nlohmann::json result;
        const auto run = options.headset             ? run_headset
                         : options.offscreen.empty() ? run_windowed
                                                     : run_offscreen;
        const int status = run(options, result);
        if (options.json && !result.is_null()) {
            std::cout << result.dump(2) << '\n';
        }
        return status;
    } catch (const std::exception& error) {
        spdlog::error("{}", error.what());
        return 1;
    }
}
