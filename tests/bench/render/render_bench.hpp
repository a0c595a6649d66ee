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
    int eyes = 200;   ///< poses at which the picture's POGO and that of the server's rays are compared
    int poses = 200;  ///< of a lens, over rest, best view and tube: open edges and crossing triangles
    int costs = 11;   ///< pictures measured per view and size
    bool only_costs = false;  ///< only pictures of that width and height, and nothing else
    std::string quality;      ///< quality that is measured; empty: what the driver can afford
    bool pictures = true;
    std::filesystem::path golden;  ///< folder of reference pictures; empty: none
    bool renew = false;            ///< writes them instead
    std::filesystem::path before;  ///< `out` of an earlier run; empty: none
};

/// Measures the pictures at six moments of scripted attempts, writes render.csv, pictures and one contact
/// sheet per attempt into `out`, and prints each measure with its goal. Pictures that `before` has, too, are
/// written beside those to `out`/before_after. Returns an exit status.
int render_bench(const RenderOptions& options);

}  // namespace eti::bench
