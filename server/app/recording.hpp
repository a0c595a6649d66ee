// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/scenario/scenario.hpp"
#include "common/session/damage.hpp"
#include "common/session/reader.hpp"

namespace eti::app {

/// All that a session file says of a session.
struct Recording {
    explicit Recording(const std::filesystem::path& path);

    /// Whether the file has what was recorded of a row of a series.
    [[nodiscard]] bool holds(const std::string& series, std::size_t row) const;
    /// Whether the run was summed up: its summary is the first then.
    [[nodiscard]] bool summed_up() const { return !summaries.empty() && summaries.front().attempt == 0; }

    session::SessionReader reader;
    std::vector<session::Damage> damage;  ///< that a repair left
    session::SceneRecord scene;           ///< without frames where a repair found none
    std::vector<session::StepRecord> steps;
    std::vector<session::StateRecord> states;
    std::vector<session::CommandRecord> commands;
    std::vector<session::DeformationRecord> deformations;
    std::vector<session::FluidRecord> fluids;
    std::vector<session::EventRecord> events;
    std::vector<session::AnnotationRecord> annotations;
    std::vector<session::SummaryRecord> summaries;
};

/// Reads a file in a child process first, as it may come from anybody, and the library that reads it can
/// crash on a damaged one. Throws InputError or hdf5::Error, also where there is no step.
[[nodiscard]] Recording read_recording(const std::filesystem::path& path);

/// Whether a tool can be there: finite, turned by a unit quaternion, within 10 m of the patient.
[[nodiscard]] bool is_pose(const RigidTransform& pose);

/// The recorded scenario, with some of its values set otherwise (KEY=VALUE; those of what lives are left
/// out). A patient's model is looked for beside `file`, then where the scenario was. Throws InputError.
[[nodiscard]] Scenario scenario_of(const std::filesystem::path& file, const session::SessionInfo& info,
                                   const std::vector<std::string>& settings);

}  // namespace eti::app
