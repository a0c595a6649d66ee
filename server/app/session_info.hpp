// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/scenario/scenario.hpp"
#include "common/session/record.hpp"
#include "server/metrics/metrics.hpp"
#include "server/patient/model/patient.hpp"

namespace eti::app {

using session::libraries_text, session::patient_hash_text, session::processor_text;
/// Name of another text of a session's file.
inline constexpr const char* scenario_folder_text = "scenario_folder";

/// What a session file says of a session that this program simulates here: scenario, version and all that its
/// bits depend on. Name, operator and start time are the caller's.
[[nodiscard]] session::SessionInfo session_info(const Scenario& scenario, const anatomy::Patient& patient);

/// A sentence for each thing that bits depend on and that is not the same; what one of them does not say
/// does not count.
[[nodiscard]] std::vector<std::string> differences(const session::SessionInfo& recorded,
                                                   const session::SessionInfo& here);

/// The run, then its attempts.
[[nodiscard]] std::vector<session::SummaryRecord> summaries_of(const metrics::Metrics& metrics);

/// The same as one object. `summaries`: the run first.
[[nodiscard]] nlohmann::ordered_json result_json(std::span<const session::SummaryRecord> summaries);

}  // namespace eti::app
