// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/scenario/scenario.hpp"
#include "common/session/reader.hpp"
#include "common/session/repair/damage.hpp"

namespace eti::app {

/// Contents of a session file.
struct Recording {
    explicit Recording(const std::filesystem::path& path);

    /// Whether the file contains this row of a series.
    [[nodiscard]] bool has_row(const std::string& series, std::size_t row) const;
    /// Whether the run has a summary; if so, it is the first.
    [[nodiscard]] bool has_run_summary() const {
        return !summaries.empty() && summaries.front().attempt == 0;
    }

    session::SessionReader reader;
    std::vector<session::Damage> damage;  ///< left by a repair
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

/// Reads a file, first in a child process: the file may come from anywhere, and the HDF5 library can crash on
/// a damaged one. Throws InputError or hdf5::Error, also if it has no steps.
[[nodiscard]] Recording read_recording(const std::filesystem::path& path);

/// The recorded scenario with overrides KEY=VALUE (runtime parameters are skipped). A patient's model is
/// searched for beside `file`, then at the scenario's location. Throws InputError.
[[nodiscard]] Scenario scenario_of(const std::filesystem::path& file, const session::SessionInfo& info,
                                   const std::vector<std::string>& settings);

}  // namespace eti::app
