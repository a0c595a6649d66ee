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

using session::libraries_text, session::patient_hash_text, session::physics_text, session::processor_text;
/// Name of a further text in a session file.
inline constexpr const char* scenario_folder_text = "scenario_folder";

/// Metadata of a session simulated by this program: scenario, version and everything that its bits depend on.
/// The caller fills in name, operator and start time.
[[nodiscard]] session::SessionInfo session_info(const Scenario& scenario, const patient::Patient& patient);

/// One sentence for each difference that affects bits; items that one of the two lacks are not compared.
[[nodiscard]] std::vector<std::string> differences(const session::SessionInfo& recorded,
                                                   const session::SessionInfo& here);

/// Summary records: the run first, then its attempts.
[[nodiscard]] std::vector<session::SummaryRecord> summaries_of(const metrics::Metrics& metrics);

/// The summaries as one JSON object. `summaries`: the run first.
[[nodiscard]] nlohmann::ordered_json result_json(std::span<const session::SummaryRecord> summaries);

}  // namespace eti::app
