// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/bus/security/session_keys.hpp"
#include "common/model/attempt_metrics.hpp"

namespace eti::bus {

/// Outcome of an attempt, or of the whole run.
struct AttemptReport {
    std::uint32_t attempt = 0;   ///< 0: the whole run
    std::uint64_t ended_ns = 0;  ///< simulation time
    Outcome outcome;
    AttemptMetrics metrics;
};

/// The message with its header's time.
[[nodiscard]] msg::AttemptSummary encode_attempt(const AttemptReport& report, std::uint32_t number);

/// Validates a message: metrics must be finite or NaN, the reason printable. Returns nullopt if rejected,
/// with the reason in `why`. `keys`: identifies the values.
[[nodiscard]] std::optional<AttemptReport> decode_attempt(const msg::AttemptSummary& message,
                                                          const SessionKeys& keys, std::string& why);

}  // namespace eti::bus
