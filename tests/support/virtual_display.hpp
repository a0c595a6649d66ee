// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>

namespace eti::test {

/// An X server without a screen (Xvfb), on a free display number; DISPLAY names it during this object's
/// lifetime.
class VirtualDisplay {
  public:
    VirtualDisplay() {
        std::array<int, 2> ends{};
        if (::pipe(ends.data()) != 0) {
            return;
        }
        process_ = ::fork();
        if (process_ == 0) {
            ::close(ends[0]);
            const std::string number = std::to_string(ends[1]);
            const int silence = ::open("/dev/null", O_WRONLY);
            ::dup2(silence, STDERR_FILENO);
            // Without -noreset, the server resets when its last client disconnects and refuses new clients
            // meanwhile.
            ::execlp("Xvfb", "Xvfb", "-displayfd", number.c_str(), "-screen", "0", "800x600x24", "-nolisten",
                     "tcp", "-noreset", nullptr);
            ::_exit(127);
        }
        ::close(ends[1]);
        std::string display;
        for (char c = 0; ::read(ends[0], &c, 1) == 1 && c != '\n';) {
            display += c;
        }
        ::close(ends[0]);
        if (!display.empty()) {
            ::setenv("DISPLAY", (":" + display).c_str(), 1);
            ready_ = true;
        }
    }
    ~VirtualDisplay() {
        if (process_ > 0) {  // any other value would signal a whole process group
            ::kill(process_, SIGTERM);
            ::waitpid(process_, nullptr, 0);
        }
        ::unsetenv("DISPLAY");
    }
    VirtualDisplay(const VirtualDisplay&) = delete;
    VirtualDisplay& operator=(const VirtualDisplay&) = delete;
    [[nodiscard]] bool ready() const { return ready_; }

  private:
    pid_t process_ = -1;
    bool ready_ = false;
};

}  // namespace eti::test
