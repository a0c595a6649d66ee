// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/security/identity.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace eti::bus {

namespace fs = std::filesystem;

void apply_identity(const Options& options, dds::DomainParticipantQos& qos,
                    std::vector<std::string>& warnings) {
    if (options.identity.empty()) {
        return;
    }
    if (!options.discovery_servers.empty()) {
        // With Fast DDS 2.9.1 no endpoint is ever matched, whether or not the server has an identity.
        throw BusError(
            "--identity together with --discovery-server: this version of the DDS library does not support "
            "both; reach the other machines by --peer ADDRESS or --network");
    }
    IdentityCheck check =
        check_identity(options.identity, options.session, options.domain, std::time(nullptr));
    if (!check.faults.empty()) {
        throw BusError(fmt::format("{}", fmt::join(check.faults, "\n")));
    }
    warnings.insert(warnings.end(), check.warnings.begin(), check.warnings.end());
    const fs::path folder = fs::absolute(options.identity);
    auto& properties = qos.properties().properties();
    const auto add = [&](const char* name, const std::string& value) {
        properties.emplace_back(name, value);
    };
    const auto file = [&](const char* name) { return "file://" + (folder / name).string(); };
    add("dds.sec.auth.plugin", "builtin.PKI-DH");
    add("dds.sec.auth.builtin.PKI-DH.identity_ca", file("identity_ca.pem"));
    add("dds.sec.auth.builtin.PKI-DH.identity_certificate", file("certificate.pem"));
    add("dds.sec.auth.builtin.PKI-DH.private_key", file("key.pem"));
    add("dds.sec.access.plugin", "builtin.Access-Permissions");
    add("dds.sec.access.builtin.Access-Permissions.permissions_ca", file("permissions_ca.pem"));
    add("dds.sec.access.builtin.Access-Permissions.governance", file("governance.p7s"));
    add("dds.sec.access.builtin.Access-Permissions.permissions", file("permissions.p7s"));
    add("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
}

std::string endpoint_creation_error(const Options& options, std::string_view topic, bool write) {
    const char* verb = write ? "write" : "read";
    if (!options.identity.empty()) {
        const IdentityCheck check =
            check_identity(options.identity, options.session, options.domain, std::time(nullptr));
        return fmt::format(
            "cannot {} topic {}: the permissions in {} do not allow this to '{}' (role {}); use an identity "
            "whose role does (docs/security.md)",
            verb, topic, options.identity.string(), check.name, check.role);
    }
    return fmt::format("cannot {} topic {}: the DDS library rejected it; see the lines above", verb, topic);
}

}  // namespace eti::bus
