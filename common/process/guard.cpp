// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/guard.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>

#include "common/process/escaped.hpp"

namespace eti {

namespace {

void limit(decltype(RLIMIT_CORE) resource, rlim_t most) {
    struct rlimit limits {};
    ::getrlimit(resource, &limits);
    limits.rlim_cur = std::min(most, limits.rlim_max);
    ::setrlimit(resource, &limits);
}

}  // namespace

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
    int status = 0;
    while (::waitpid(child, &status, 0) < 0) {
        if (errno != EINTR) {
            return {1, fmt::format("the child process was lost: {}", std::strerror(errno))};
        }
    }
    if (WIFSIGNALED(status)) {
        return {1, fmt::format("signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status)))};
    }
    return {WEXITSTATUS(status), std::nullopt};
}

}  // namespace eti
