// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/guard.hpp"

#include <poll.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <utility>

#include "common/process/escaped.hpp"
#include "common/process/files/descriptor.hpp"
#include "common/process/stop_signal.hpp"

namespace eti {

namespace {

void limit(decltype(RLIMIT_CORE) resource, rlim_t most) {
    struct rlimit limits {};
    ::getrlimit(resource, &limits);
    limits.rlim_cur = std::min(most, limits.rlim_max);
    ::setrlimit(resource, &limits);
}

/// Waits until the child has ended, a signal has arrived, or a while has passed.
void await(pid_t child) {
    constexpr int poll_interval_ms = 100;
    // Unlike waitpid(), poll() returns after a handled signal, whatever the handler's flags.
    const Descriptor process(static_cast<int>(::syscall(SYS_pidfd_open, child, 0)));
    pollfd ended{process.get(), POLLIN, 0};
    (void)::poll(&ended, process ? 1 : 0, process ? poll_interval_ms : 1);
}

}  // namespace

void end_at_once_on_stop() {
    ::signal(SIGINT, SIG_DFL);
    ::signal(SIGTERM, SIG_DFL);
    if (stop_requested()) {  // before the fork, or by the handler until now
        ::raise(SIGTERM);
    }
}

GuardedResult run_guarded(const std::function<int()>& task, const GuardLimits& limits) {
    std::cout.flush();
    std::cerr.flush();
    std::fflush(nullptr);
    const pid_t child = ::fork();
    if (child < 0) {
        return {1, fmt::format("cannot start a child process: {}", std::strerror(errno))};
    }
    if (child == 0) {
        limit(RLIMIT_CORE, 0);
        limit(RLIMIT_CPU, limits.processor_seconds);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
        // Sanitizers reserve terabytes of address space.
        limit(RLIMIT_AS, limits.memory_bytes);
#endif
        int status = 1;
        try {
            status = task();
        } catch (const std::exception& error) {
            std::cerr << escaped_lines(error.what()) << '\n';
        }
        std::cout.flush();
        std::fflush(nullptr);
        // Skip destructors of static objects: they belong to the parent.
        ::_exit(status);
    }
    bool passed_on = false;
    int status = 0;
    for (pid_t ended = 0; ended == 0;) {
        await(child);
        ended = ::waitpid(child, &status, WNOHANG);
        if (ended < 0 && errno != EINTR) {
            return {1, fmt::format("the child process was lost: {}", std::strerror(errno))};
        }
        ended = std::max(ended, 0);
        // A signal to this process alone, unlike Ctrl-C, does not reach the child.
        if (ended == 0 && stop_requested() && !std::exchange(passed_on, true)) {
            ::kill(child, SIGTERM);
        }
    }
    const bool by_stop = WIFSIGNALED(status) && (WTERMSIG(status) == SIGTERM || WTERMSIG(status) == SIGINT);
    if (by_stop && stop_requested()) {
        return {status_stopped, std::nullopt, true};
    }
    if (WIFSIGNALED(status)) {
        return {1, fmt::format("signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status)))};
    }
    return {WEXITSTATUS(status), std::nullopt};
}

}  // namespace eti
