// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/attempt_report.hpp"

#include <algorithm>
#include <cmath>

#include "client/view/text.hpp"

namespace eti::view {

std::optional<AttemptReport> decode(const msg::AttemptSummary& message, const bus::SessionKeys& keys,
                                    std::string& why) {
    // NaN marks values that an attempt does not have.
    if (std::ranges::any_of(message.parameters(), [](double value) { return std::isinf(value); })) {
        why = "an infinite parameter";
        return std::nullopt;
    }
    AttemptReport report;
    report.attempt = message.attempt();
    report.ended_ns = message.header().simulation_time_ns();
    report.outcome.success = message.success();
    report.outcome.reason = message.reason().to_string();
    report.metrics = keys.metrics(message.parameters());
    report.outcome.known = airway_measured(report.metrics);
    if (!printable(report.outcome.reason)) {
        why = "a reason with control characters";
        return std::nullopt;
    }
    return report;
}

}  // namespace eti::view
