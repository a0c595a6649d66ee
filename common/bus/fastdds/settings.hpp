// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <filesystem>
#include <string>

#include "common/bus/fastdds/names.hpp"

namespace eti::bus {

/// Two participants of one process then communicate as two processes do.
void turn_off_intraprocess_delivery();

enum class ProfileResult { found, invalid_file, no_such_profile };

/// Reads the participant profile `name` from an XML file, whatever files were read before.
[[nodiscard]] ProfileResult read_profile(const std::filesystem::path& file, const std::string& name,
                                         dds::DomainParticipantQos& qos);

/// Makes the participant a client of the discovery server at `locator`; by its GUID prefix where the library
/// tells servers apart so.
void add_discovery_server(const rtps::Locator_t& locator, const std::string& guid_prefix,
                          dds::DomainParticipantQos& qos);

/// Makes the participant a discovery server.
void make_discovery_server(dds::DomainParticipantQos& qos);

}  // namespace eti::bus
