// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/output/session_info.hpp"

#include <fmt/format.h>
#include <gnu/libc-version.h>

#include <fstream>

#include "common/model/attempt_metrics_json.hpp"
#include "server/app/output/recorder.hpp"
#include "server/patient/model/patient_hash.hpp"
#include "server/pbd/lanes.hpp"
#include "server/rigid/rigid_layer.hpp"
#include "server/scene/physics_version.hpp"

namespace eti::app {

namespace {

std::string model_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        if (const std::size_t colon = line.find(": ");
            line.starts_with("model name") && colon != std::string::npos) {
            return line.substr(colon + 2);
        }
    }
    return "unknown";
}

}  // namespace

session::SessionInfo session_info(const Scenario& scenario, const patient::Patient& patient) {
    session::SessionInfo info;
    info.scenario = scenario.name;
    info.scenario_text = scenario.text;
    info.version = ETI_VERSION;
    info.build = build_description();
    info.more[processor_text] =
        fmt::format("{}, {}", model_name(), pbd::has_avx2() ? "kernels for AVX2" : "plain kernels");
    info.more[libraries_text] =
        fmt::format("glibc {}, Bullet {}", ::gnu_get_libc_version(), rigid::library_version());
    info.more[physics_text] = scene::physics_version;
    info.more[patient_hash_text] = fmt::format("{:016x}", patient::hash_of(patient));
    if (scenario.manikin) {
        info.more[session::manikin_text] = "on";
    }
    if (!scenario.patient.model.empty()) {
        info.more[scenario_folder_text] = std::filesystem::absolute(scenario.folder).string();
    }
    return info;
}

std::vector<std::string> differences(const session::SessionInfo& recorded, const session::SessionInfo& here) {
    std::vector<std::string> out;
    const auto compare = [&](const char* what, const std::string& then, const std::string& now) {
        if (!then.empty() && !now.empty() && then != now) {
            out.push_back(fmt::format("different {}: {} in the recording, {} here", what, then, now));
        }
    };
    compare("version", recorded.version, here.version);
    compare("build", recorded.build, here.build);
    compare("processor", recorded.text(processor_text), here.text(processor_text));
    compare("set of libraries", recorded.text(libraries_text), here.text(libraries_text));
    const std::string physics = recorded.text(physics_text);
    compare("physics", physics.empty() ? "an earlier version" : physics, here.text(physics_text));
    compare("patient, by the hash of its model", recorded.text(patient_hash_text),
            here.text(patient_hash_text));
    return out;
}

std::vector<session::SummaryRecord> summaries_of(const metrics::Metrics& metrics) {
    const metrics::AttemptSummary run = metrics.run();
    std::vector<session::SummaryRecord> out{{0, run.outcome, run.metrics}};
    for (const metrics::AttemptSummary& a : metrics.attempts()) {
        out.push_back({a.number, a.outcome, a.metrics});
    }
    return out;
}

nlohmann::ordered_json result_json(std::span<const session::SummaryRecord> summaries) {
    const auto object = [](const session::SummaryRecord& summary) {
        return nlohmann::ordered_json{
            {"success", summary.outcome.known ? nlohmann::ordered_json(summary.outcome.success)
                                              : nlohmann::ordered_json()},
            {"reason", summary.outcome.reason},
            {"parameters", metrics_to_json(summary.metrics)}};
    };
    nlohmann::ordered_json out = object(summaries.front());
    out["attempts"] = nlohmann::ordered_json::array();
    for (const session::SummaryRecord& attempt : summaries.subspan(1)) {
        nlohmann::ordered_json entry{{"attempt", attempt.attempt}};
        entry.update(object(attempt));
        out["attempts"].push_back(std::move(entry));
    }
    return out;
}

}  // namespace eti::app
