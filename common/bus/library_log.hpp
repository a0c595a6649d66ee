// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <spdlog/spdlog.h>

#include <string>

namespace eti::bus {

/// Logger of common/bus, on standard error whatever the program's default logger is.
[[nodiscard]] spdlog::logger& bus_log();

/// Redirects the DDS library's log to bus_log(), at most one line a second per cause. Once for all nodes.
void set_up_library_log();

/// Version of the DDS library at build time: "2.9.1".
[[nodiscard]] std::string library_version();

}  // namespace eti::bus
