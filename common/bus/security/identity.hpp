// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/fastdds/names.hpp"
#include "common/bus/security/identity_check.hpp"

namespace eti::bus {

/// Enables authentication in both directions and encryption. Does nothing without Options::identity. Throws
/// BusError with the faults that check_identity() finds.
void apply_identity(const Options& options, dds::DomainParticipantQos& qos,
                    std::vector<std::string>& warnings);

/// Why the library created no reader or writer, and the remedy.
[[nodiscard]] std::string endpoint_creation_error(const Options& options, std::string_view topic, bool write);

}  // namespace eti::bus
