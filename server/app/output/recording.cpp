// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/output/recording.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/process/guard.hpp"
#include "common/scenario/setting.hpp"
#include "server/app/output/session_info.hpp"

namespace eti::app {

Recording::Recording(const std::filesystem::path& path)
    : reader(path),
      damage(session::read_damage(reader.root())),
      scene(session::is_known_lost(damage, "scene") ? session::SceneRecord{} : reader.scene()),
      steps(reader.steps()),
      states(reader.states()),
      commands(reader.commands()),
      deformations(reader.deformations()),
      fluids(reader.fluids()),
      events(reader.events()),
      annotations(reader.annotations()),
      summaries(reader.summaries()) {}

bool Recording::has_row(const std::string& series, std::size_t row) const {
    return reader.root().has(series) && std::ranges::none_of(damage, [&](const session::Damage& lost) {
               return lost.path == series && row >= lost.first && row - lost.first < lost.count;
           });
}

Recording read_recording(const std::filesystem::path& path) {
    const GuardedResult tried = run_guarded([&] {
        try {
            const Recording read(path);
            return 0;
        } catch (const std::exception&) {
            return 0;  // reported below
        }
    });
    if (tried.broken) {
        throw InputError(fmt::format("{}: damaged: reading failed with {}", path.string(), *tried.broken));
    }
    Recording recording(path);
    if (recording.steps.empty()) {
        throw InputError(fmt::format("{}: contains no step", path.string()));
    }
    return recording;
}

Scenario scenario_of(const std::filesystem::path& file, const session::SessionInfo& info,
                     const std::vector<std::string>& settings) {
    std::string text = info.scenario_text;
    for (const std::string& setting : settings) {
        if (find_runtime_parameter_by_key(key_of(setting)) == nullptr) {
            text = with_setting(text, setting);
        }
    }
    const auto in_folder = [&](const std::filesystem::path& folder) {
        Scenario scenario =
            parse_scenario(text, folder / fmt::format("the scenario in {}", file.filename().string()));
        scenario.name = info.scenario;
        return scenario;
    };
    // A model is searched for beside the file, then at the scenario's location.
    Scenario scenario = in_folder(file.parent_path());
    std::error_code error;
    const auto folder = info.more.find(scenario_folder_text);
    if (const auto& beside = scenario.patient.model;
        !beside.empty() && !std::filesystem::exists(beside, error) && folder != info.more.end()) {
        scenario = in_folder(folder->second);
        if (!std::filesystem::exists(scenario.patient.model, error)) {
            throw InputError(
                fmt::format("{}: its patient model is neither {} nor {}; copy it to one of these places",
                            file.string(), beside.string(), scenario.patient.model.string()));
        }
    }
    return scenario;
}

}  // namespace eti::app
