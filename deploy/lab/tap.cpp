// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "deploy/lab/tap.hpp"

#include <fcntl.h>
#include <linux/if.h>
#include <linux/if_tun.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

namespace eti::lab {

namespace {

[[noreturn]] void fail(const std::string& what) {
    throw std::system_error(errno, std::generic_category(), what);
}

/// Closes a file descriptor in its destructor.
class Opened {
  public:
    Opened(const std::filesystem::path& path, int flags) : file_(::open(path.c_str(), flags | O_CLOEXEC)) {
        if (file_ < 0) {
            fail("opening " + path.string());
        }
    }
    ~Opened() { ::close(file_); }
    Opened(const Opened&) = delete;
    Opened& operator=(const Opened&) = delete;
    [[nodiscard]] int file() const { return file_; }

  private:
    int file_;
};

void enter(int space, const std::filesystem::path& name) {
    if (::setns(space, CLONE_NEWNET) != 0) {
        fail("entering the network namespace " + name.string() +
             " (needs root, or CAP_SYS_ADMIN where it was made)");
    }
}

}  // namespace

Tap::Tap(const std::filesystem::path& space, const std::string& interface) {
    ifreq request{};
    if (interface.empty() || interface.size() >= sizeof request.ifr_name) {
        throw std::invalid_argument("interface '" + interface + "': a name has 1 to " +
                                    std::to_string(sizeof request.ifr_name - 1) + " characters");
    }
    std::memcpy(request.ifr_name, interface.data(), interface.size());
    request.ifr_flags = IFF_TAP | IFF_NO_PI;
    const Opened here("/proc/thread-self/ns/net", O_RDONLY), there(space, O_RDONLY);
    enter(there.file(), space);
    // An interface belongs to the namespace in which its file was opened.
    const int tun = ::open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC);
    const bool made = tun >= 0 && ::ioctl(tun, TUNSETIFF, &request) == 0;
    const int error = errno;
    enter(here.file(), "it came from");
    file_ = tun;
    if (!made) {
        close();
        errno = error;
        fail((tun < 0 ? "opening /dev/net/tun for " : "making the interface ") + interface + " in " +
             space.string());
    }
}

Tap::~Tap() {
    close();
}

void Tap::close() {
    if (file_ >= 0) {
        ::close(file_);
    }
    file_ = -1;
}

std::size_t Tap::read(std::span<std::uint8_t> frame) {
    const ssize_t size = ::read(file_, frame.data(), frame.size());
    return size > 0 ? static_cast<std::size_t>(size) : 0;
}

bool Tap::write(std::span<const std::uint8_t> frame) {
    return ::write(file_, frame.data(), frame.size()) == static_cast<ssize_t>(frame.size());
}

}  // namespace eti::lab
