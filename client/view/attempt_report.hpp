// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/bus/session_keys.hpp"
#include "common/model/parameters.hpp"

namespace eti::view {

/// How an attempt, or the whole run, ended.
struct AttemptReport {
    std::uint32_t attempt = 0;   ///< 0: the whole run
    std::uint64_t ended_ns = 0;  ///< simulation time
    Outcome outcome;
    Parameters parameters;
};

/// Checks what a message claims: parameters are finite or NaN, and the reason can be printed. Nothing on
/// refusal; `why` then says what was wrong. `keys`: which value is which.
[[nodiscard]] std::optional<AttemptReport> decode(const msg::AttemptSummary& message,
                                                  const bus::SessionKeys& keys, std::string& why);

}  // namespace eti::view
