// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/program.hpp"

#include <spdlog/spdlog.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "common/process/log.hpp"

namespace eti {

int run_program(const std::string& name, const std::function<std::optional<int>()>& parse,
                const std::function<int()>& work, const std::optional<StopSignals>& how) {
    set_up_log(name);
    if (how) {
        catch_stop_signals(*how);
    }
    try {
        const std::optional<int> status = parse();
        return status ? *status : work();
    } catch (const std::exception& error) {
        spdlog::error("{}", error.what());
        return 1;
    }
}

int run_program(CommandLine& app, int argc, char** argv, const std::function<int()>& work,
                const std::optional<StopSignals>& how) {
    return run_program(
        app.name(), [&] { return app.parse(argc, argv); }, work, how);
}

void print_json(bool wanted, const nlohmann::ordered_json& result) {
    if (wanted) {
        std::cout << result.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
                  << std::endl;
    }
}

}  // namespace eti
