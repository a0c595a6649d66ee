// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/tool/terminal.hpp"

#include <iostream>

#include "common/process/escaped.hpp"
#include "common/process/progress_bar.hpp"
#include "common/process/stop_signal.hpp"

namespace eti::tool {

namespace {

ProgressBar bar;

}  // namespace

bool draw_progress(float share, std::string_view what) {
    bar.draw(share, what);
    return !stop_requested();
}

void clear_progress() {
    bar.clear();
}

void remark(std::string_view text) {
    bar.clear();
    std::cerr << "eti-anatomy: " << escaped_lines(text) << '\n';
}

std::filesystem::path stem_of(const std::filesystem::path& file) {
    std::string name = file.string();
    for (const char* ending : {".nii.gz", ".nii", ".nrrd"}) {
        if (name.ends_with(ending)) {
            name.resize(name.size() - std::string_view(ending).size());
            break;
        }
    }
    return name;
}

}  // namespace eti::tool
