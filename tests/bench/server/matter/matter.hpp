// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace eti::bench {

struct MatterOptions {
    std::vector<std::string> scenarios = {"term", "premature"};
    std::vector<std::string> methods;  ///< of tissue; empty: that of each scenario
    std::filesystem::path path;        ///< of the blade; empty: the committed one of the scenario
    std::filesystem::path record;      ///< writes the expert's lift of the first scenario here instead
    std::filesystem::path out;         ///< folder for tables of this and of other settings; empty: none
    std::filesystem::path trace;       ///< writes values over time here
    int substeps = 0;                  ///< 0: as the scenario says
    double spacing = 0.0;              ///< [mm], 0: as the scenario says
    double fine_spacing = 0.0;         ///< [mm], 0: as the scenario says
    bool plate = false;                ///< the epiglottis as a plate of its own
    bool fixed_bones = false;          ///< head, mandible and hyoid do not yield
    bool elastic = false;              ///< the tissue does not relax
    bool no_blocks = false;            ///< no blocks
    bool no_hold = false;              ///< no quick lift, whose force falls while the blade is held
    bool quick = false;                ///< the first scenario and few blocks
    bool json = false;
};

/// Replays one lift of the blade in different models of the tissue and measures volume, forces, view, rest
/// and cost; then loads blocks that have an independent reference. Returns the exit status.
[[nodiscard]] int matter(const MatterOptions& options);

}  // namespace eti::bench
