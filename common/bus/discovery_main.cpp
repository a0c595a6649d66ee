// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <thread>

#include "common/bus/discovery_server.hpp"
#include "common/process/stop_signal.hpp"

int main(int argc, char** argv) {
    using namespace eti;
    spdlog::set_default_logger(spdlog::stderr_color_mt("eti-discovery"));
    catch_stop_signals();
    bus::Options options{.name = "eti-discovery"};
    int number = 0;
    std::string address;
    std::uint16_t port = bus::discovery_port;
    CLI::App app("A discovery server: tells programs that name it with --discovery-server who else is there.",
                 "eti-discovery");
    app.set_version_flag("--version", ETI_VERSION);
    app.add_option("--number", number,
                   "Its place among the --discovery-server that programs are given; 1 is a backup")
        ->capture_default_str()
        ->check(CLI::Range(0, 255));
    app.add_option("--address", address, "Address of this machine to listen on; without it, all");
    app.add_option("--port", port, "UDP port")->capture_default_str()->check(CLI::Range(1, 65535));
    app.add_option("--domain", options.domain, "DDS domain")
        ->capture_default_str()
        ->check(CLI::Range(0, 232));
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    try {
        const bus::DiscoveryServer server(options, number, address, port);
        spdlog::info("discovery server {} listens on {}:{}", number,
                     address.empty() ? "all addresses" : address, port);
        while (!stop_asked()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
    } catch (const std::exception& error) {
        spdlog::error("{}", error.what());
        return 1;
    }
    return 0;
}
