// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/terminal.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>

namespace eti {

Terminal::Terminal() {
    if (::isatty(STDIN_FILENO) == 0 || ::tcgetattr(STDIN_FILENO, &before_) != 0 ||
        ::tcgetpgrp(STDIN_FILENO) != ::getpgrp()) {
        return;
    }
    termios keys = before_;
    keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    // Receive every key, including those that would suspend output, or stop the process while a force is
    // applied.
    keys.c_iflag &= ~static_cast<tcflag_t>(IXON);
    keys.c_cc[VSUSP] = keys.c_cc[VQUIT] = _POSIX_VDISABLE;
    keys.c_cc[VMIN] = 0;
    keys.c_cc[VTIME] = 0;
    there_ = ::tcsetattr(STDIN_FILENO, TCSANOW, &keys) == 0;
}

Terminal::~Terminal() {
    if (there_) {
        ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
    }
}

std::optional<char> Terminal::key(std::chrono::milliseconds timeout) {
    pollfd waiting{STDIN_FILENO, POLLIN, 0};
    if (!there_ || ::poll(&waiting, 1, static_cast<int>(timeout.count())) <= 0) {
        return std::nullopt;
    }
    std::array<char, 1> typed{};
    if (::read(STDIN_FILENO, typed.data(), 1) != 1) {
        there_ = false;
        return '\0';
    }
    if (typed[0] != '\x1b') {
        return typed[0];
    }
    // An arrow arrives as Escape, '[' and a letter, all at once; other such keys count as Escape.
    std::array<char, 2> rest{};
    if (::poll(&waiting, 1, 0) <= 0 || ::read(STDIN_FILENO, rest.data(), 2) != 2 || rest[0] != '[') {
        return '\x1b';
    }
    switch (rest[1]) {
        case 'A':
            return 'U';
        case 'B':
            return 'D';
        case 'C':
            return 'R';
        case 'D':
            return 'L';
        default:
            return '\x1b';
    }
}

}  // namespace eti
