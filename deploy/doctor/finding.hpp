// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

namespace eti::doctor {

enum class State {
    ok,       ///< no problem
    info,     ///< for information; a session runs regardless
    problem,  ///< impairs or prevents a session
};

/// Result of one check of one item.
struct Finding {
    std::string area;   ///< "network", "session"
    std::string thing;  ///< "eth0"
    State state;
    std::string text;    ///< what was found
    std::string remedy;  ///< empty when there is no problem
};

using Findings = std::vector<Finding>;

}  // namespace eti::doctor
