// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <spdlog/spdlog.h>

#include <string>

namespace eti::bus {

/// Logger of this room, on standard error whatever the program's default logger is.
[[nodiscard]] spdlog::logger& bus_log();

/// What the DDS library reports goes to bus_log(), each cause once a second at most; once for all nodes.
void set_up_library_log();

/// Of the DDS library, as built against: "2.9.1".
[[nodiscard]] std::string library_version();

}  // namespace eti::bus
