// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

namespace eti::bus {

/// What a folder for Options::identity holds, as deploy/security/make_lab.sh makes it.
struct IdentityCheck {
    std::string name;                   ///< the certificate's common name
    std::string role;                   ///< its organisational unit
    std::string authority;              ///< who signed it
    std::time_t until = 0;              ///< when the first of its documents expires
    std::vector<std::string> faults;    ///< why it cannot be used: file, finding, remedy; a line each
    std::vector<std::string> warnings;  ///< what is better mended
};

/// Looks at every file before the library does, whose own words are "cannot join". `now` [s since 1970].
[[nodiscard]] IdentityCheck check_identity(const std::filesystem::path& folder, const std::string& session,
                                           int domain, std::time_t now);

/// UTC: "2026-01-31 12:00".
[[nodiscard]] std::string date_text(std::time_t when);

}  // namespace eti::bus
