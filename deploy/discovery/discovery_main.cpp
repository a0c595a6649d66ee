// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/spdlog.h>

#include <thread>

#include "common/bus/command_line.hpp"
#include "common/bus/discovery/discovery_server.hpp"
#include "common/process/program.hpp"

int main(int argc, char** argv) {
    using namespace eti;
    bus::Options options{.name = "eti-discovery"};
    int number = 0;
    std::string address;
    std::uint16_t port = bus::discovery_port;
    CommandLine app("A discovery server: lets programs that name it with --discovery-server find each other.",
                    "eti-discovery");
    app.add_number("--number", number,
                   "Its position among the --discovery-server options of the programs; 1 is a backup",
                   {0, 255})
        .capture_default_str();
    app.add_option("--address", address, "Address of this machine to listen on; by default all");
    app.add_number("--port", port, "UDP port", {1}).capture_default_str();
    bus::add_domain(app, options);
    return run_program(app, argc, argv, [&] {
        const bus::DiscoveryServer server(options, number, address, port);
        spdlog::info("discovery server {} listens on {}:{}", number,
                     address.empty() ? "all addresses" : address, port);
        while (!stop_requested()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
        return 0;
    });
}
