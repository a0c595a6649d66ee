// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/headset/headset.hpp"
#include "client/app/offscreen/offscreen.hpp"
#include "client/app/options.hpp"
#include "client/app/window/windowed.hpp"
#include "common/process/program.hpp"

int main(int argc, char** argv) {
    using namespace eti::client;
    Options options;
    const auto work = [&] {
        nlohmann::json result;
        const auto run = options.headset             ? run_headset
                         : options.offscreen.empty() ? run_windowed
                                                     : run_offscreen;
        const int status = run(options, result);
        eti::print_json(options.json && !result.is_null(), result);
        return status;
    };
    return eti::run_program(
        "eti-client", [&] { return parse(argc, argv, options); }, work,
        eti::StopSignals{.second_ends = true});
}
