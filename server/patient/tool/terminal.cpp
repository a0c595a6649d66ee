// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/tool/terminal.hpp"

#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <iostream>
#include <mutex>

#include "common/process/stop_signal.hpp"

namespace eti::tool {

namespace {

class ProgressBar {
  public:
    void draw(float share, std::string_view what) {
        const auto now = std::chrono::steady_clock::now();
        const std::lock_guard lock(mutex_);
        if (on_terminal_ && now - drawn_ > std::chrono::milliseconds(100)) {
            drawn_ = now;
            const auto full = static_cast<std::size_t>(30.0f * std::clamp(share, 0.0f, 1.0f));
            std::cerr << fmt::format("\r\033[K[{:<30}] {:3.0f} % {}", std::string(full, '='), 100.0f * share,
                                     what)
                      << std::flush;
        }
    }
    void clear() const {
        if (on_terminal_) {
            std::cerr << "\r\033[K";
        }
    }

  private:
    bool on_terminal_ = ::isatty(STDERR_FILENO) != 0;
    std::chrono::steady_clock::time_point drawn_{};
    std::mutex mutex_;
};

ProgressBar bar;

}  // namespace

bool draw_progress(float share, std::string_view what) {
    bar.draw(share, what);
    return !stop_asked();
}

void clear_progress() {
    bar.clear();
}

void remark(std::string_view text) {
    bar.clear();
    std::cerr << "eti-anatomy: " << text << '\n';
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
