// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

namespace eti::doctor {

enum class State {
    well,  ///< as it should be
    note,  ///< good to know; a session runs all the same
    mend,  ///< keeps a session from running well
};

/// What one look at one thing found.
struct Finding {
    std::string area;   ///< "network", "session"
    std::string thing;  ///< "eth0"
    State state;
    std::string text;    ///< what was found
    std::string remedy;  ///< what to do; empty when all is well
};

using Findings = std::vector<Finding>;

}  // namespace eti::doctor
