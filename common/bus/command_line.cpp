// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/command_line.hpp"

#include "common/process/command_line.hpp"

namespace eti::bus {

Option add_domain(CommandLine& app, Options& options) {
    // 232 is the last domain whose port numbers, by the DDS interoperability protocol, are valid.
    return app.add_number("--domain", options.domain, "DDS domain", {0, 232}).capture_default_str();
}

void add_options(CommandLine& app, Options& options) {
    constexpr const char* group = "Session";
    app.add_option("--session", options.session, "Session name; several sessions share a domain")
        .capture_default_str()
        .group(group);
    add_domain(app, options).group(group);
    app.add_flag(
           "--network", options.network,
           "Discover programs on other machines by multicast. Anyone on their networks can then read the "
           "session and send to it, unless --interface or --identity keeps him out. Without it and "
           "--peer, --discovery-server or --profile, only programs on this machine")
        .group(group);
    app.add_option(
           "--interface", options.interface,
           "Reach other machines through this network interface only, by name or IPv4 address: that of "
           "a lab's own WireGuard network (see deploy/security/make_network.py)")
        .group(group);
    app.add_option(
           "--peer", options.peers,
           "Another machine of the session by name or IPv4 address, if multicast does not reach it; may "
           "be repeated")
        .allow_extra_args(false)
        .group(group);
    app.add_option("--discovery-server", options.discovery_servers,
                   "HOST or HOST:PORT of a discovery server, through which programs find each other; a "
                   "second one is its backup")
        .allow_extra_args(false)
        .group(group);
    app.add_option("--profile", options.profile,
                   "Fast DDS XML profile, for any other setup (see deploy/data/dds)")
        .existing_file()
        .group(group);
    app.add_option("--identity", options.identity,
                   "Folder with this program's certificate and permissions: encrypt, and admit only programs "
                   "with an identity of the same lab (see deploy/security)")
        .existing_folder()
        .group(group);
}

}  // namespace eti::bus
