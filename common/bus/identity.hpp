// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/identity_check.hpp"

namespace eti::bus {

/// Has the participant prove its identity, ask others for theirs and encrypt. Does nothing without
/// Options::identity. Throws BusError: the faults of the check above.
void apply_identity(const Options& options, eprosima::fastdds::dds::DomainParticipantQos& quality,
                    std::vector<std::string>& warnings);

/// Why the library made no reader or writer, and what to do.
[[nodiscard]] std::string endpoint_refused(const Options& options, std::string_view topic, bool write);

}  // namespace eti::bus
