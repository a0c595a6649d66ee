// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <ctime>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"

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

/// Has the participant prove its identity, ask others for theirs and encrypt. Does nothing without
/// Options::identity. Throws BusError: the faults of the check above.
void apply_identity(const Options& options, eprosima::fastdds::dds::DomainParticipantQos& quality,
                    std::vector<std::string>& warnings);

/// Why the library made no reader or writer, and what to do.
[[nodiscard]] std::string endpoint_refused(const Options& options, std::string_view topic, bool write);

}  // namespace eti::bus
