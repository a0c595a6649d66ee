// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/progress_bar.hpp"

#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <iostream>
#include <string>

namespace eti {

ProgressBar::ProgressBar() : on_terminal_(::isatty(STDERR_FILENO) != 0) {}

void ProgressBar::draw(float share, std::string_view what) {
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

void ProgressBar::clear() const {
    if (on_terminal_) {
        std::cerr << "\r\033[K";
    }
}

}  // namespace eti
