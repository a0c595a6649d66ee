// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/drop_log.hpp"

#include <spdlog/spdlog.h>

namespace eti::view {

void DropLog::note(std::string_view topic, std::string_view why) {
    ++count_;
    const auto now = std::chrono::steady_clock::now();
    if (count_ > 1 && now - last_line_ < std::chrono::seconds(1)) {
        return;
    }
    last_line_ = now;
    spdlog::warn("dropped a message on {}: {} ({} dropped so far)", topic, why, count_);
}

}  // namespace eti::view
