// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

#include "common/bus/bus.hpp"

namespace eti::bus {

/// A program of this project that the node has met on its domain, in whatever session.
struct MetProgram {
    std::string name;  ///< "eti-client"
    std::string session;
    std::string process;  ///< host:pid
    int protocol = 0;
    std::string version;
    bool serves = false;  ///< it writes the status of the node's session
};

/// By name and process.
[[nodiscard]] std::vector<MetProgram> met_programs(const Node& node);

}  // namespace eti::bus
