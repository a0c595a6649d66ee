// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/codec/attempt_report.hpp"

#include <algorithm>
#include <cmath>

#include "common/bus/codec/convert.hpp"
#include "common/model/utf8.hpp"

namespace eti::bus {

msg::AttemptSummary encode_attempt(const AttemptReport& report, std::uint32_t number) {
    msg::AttemptSummary message;
    message.header(make_header(report.ended_ns, number));
    message.attempt(report.attempt);
    message.success(report.outcome.success);
    message.reason(report.outcome.reason);
    message.parameters(to_msg(report.metrics));
    return message;
}

std::optional<AttemptReport> decode_attempt(const msg::AttemptSummary& message, const SessionKeys& keys,
                                            std::string& why) {
    // NaN marks values that an attempt does not have.
    if (std::ranges::any_of(message.parameters(), [](double value) { return std::isinf(value); })) {
        why = "an infinite metric";
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

}  // namespace eti::bus
