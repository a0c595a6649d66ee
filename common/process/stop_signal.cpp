// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/stop_signal.hpp"

#include <signal.h>

#include <atomic>
#include <initializer_list>

namespace eti {

namespace {

std::atomic<bool> asked{false};
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void on_stop_signal(int /*number*/) {
    asked.store(true);
}

}  // namespace

void catch_stop_signals(const StopSignals& how) {
    struct sigaction action {};
    action.sa_handler = on_stop_signal;
    action.sa_flags = how.holds_device ? 0 : SA_RESTART;
    action.sa_flags |= how.second_ends ? static_cast<int>(SA_RESETHAND) : 0;
    for (const int signal : {SIGINT, SIGTERM}) {
        ::sigaction(signal, &action, nullptr);
    }
    if (how.holds_device) {
        for (const int signal : {SIGHUP, SIGQUIT}) {
            ::sigaction(signal, &action, nullptr);
        }
        ::signal(SIGPIPE, SIG_IGN);
    }
}

bool stop_requested() {
    return asked.load();
}

void request_stop(bool stop) {
    asked.store(stop);
}

}  // namespace eti
