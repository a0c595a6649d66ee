// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace eti::bench {

struct RenderOptions {
    std::filesystem::path out = "out/render";
    std::vector<std::string> scenarios = {"term", "premature", "term_enhanced", "premature_enhanced"};
    std::vector<std::string> operators = {"expert", "novice", "no_lift"};
    int width = 1920, height = 1080;
    int eyes = 200;  ///< poses from which the picture's POGO and that of the server's rays are compared
    int costs = 11;  ///< pictures of each view and size whose cost is measured
    bool only_costs = false;  ///< of pictures of that width and height alone, and nothing else
    std::string quality;      ///< whose cost is measured; empty: what the driver can afford
    bool pictures = true;
    std::filesystem::path golden;  ///< pictures to compare with; empty: none
    bool renew = false;            ///< write them instead
};

/// Measures what is seen at six moments of scripted attempts, writes render.csv, pictures and a contact sheet
/// an attempt into `out`, and prints how each measure stands to its goal. Returns an exit status.
int render_bench(const RenderOptions& options);

}  // namespace eti::bench
