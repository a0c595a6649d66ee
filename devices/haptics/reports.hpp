// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "devices/haptics/scene_state.hpp"
#include "idl/eti_wire.hpp"

namespace eti::devices {

/// Read a message of the server. False, and the report is unchanged, if a number is not finite or beyond what
/// any session sends.
[[nodiscard]] bool read_report(const msg::ProxyState& message, ProxyReport& report);
[[nodiscard]] bool read_report(const msg::TissueContacts& message, TissueReport& report);
/// Sets the wrench alone.
[[nodiscard]] bool read_report(const msg::TubeForce& message, TissueReport& report);

}  // namespace eti::devices
