// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

namespace eti::bus {

/// Contents of a folder for Options::identity, as deploy/security/make_lab.sh creates it.
struct IdentityCheck {
    std::string name;                   ///< the certificate's common name
    std::string role;                   ///< its organisational unit
    std::string authority;              ///< the signer
    std::time_t until = 0;              ///< earliest expiry date of its documents
    std::vector<std::string> faults;    ///< why it is unusable: file, problem, remedy; one line each
    std::vector<std::string> warnings;  ///< what should be fixed
};

/// Checks every file before the library does, which only reports "cannot join". `now` [s since 1970].
[[nodiscard]] IdentityCheck check_identity(const std::filesystem::path& folder, const std::string& session,
                                           int domain, std::time_t now);

/// UTC: "2026-01-31 12:00".
[[nodiscard]] std::string date_text(std::time_t when);

}  // namespace eti::bus
