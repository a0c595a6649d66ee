// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/study/prompt.hpp"

#include <poll.h>
#include <unistd.h>

#include "common/process/stop_signal.hpp"

namespace eti::review {

std::optional<std::string> read_line() {
    static std::string waiting;
    for (;;) {
        if (const std::size_t end = waiting.find('\n'); end != std::string::npos) {
            std::string line = waiting.substr(0, end);
            waiting.erase(0, end + 1);
            return line;
        }
        pollfd input{STDIN_FILENO, POLLIN, 0};
        char bytes[512];
        if (stop_requested() || ::poll(&input, 1, 200) < 0) {
            if (stop_requested()) {
                return std::nullopt;
            }
            continue;
        }
        if (input.revents == 0) {
            continue;
        }
        const ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
        if (count <= 0) {
            return std::nullopt;
        }
        waiting.append(bytes, static_cast<std::size_t>(count));
    }
}

}  // namespace eti::review
