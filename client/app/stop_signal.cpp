// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/stop_signal.hpp"

#include <atomic>
#include <csignal>

namespace eti::client {
namespace {

std::atomic<bool> asked{false};
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void on_stop_signal(int number) {
    asked.store(true);
    std::signal(number, SIG_DFL);
}

}  // namespace

void catch_stop_signals() {
    std::signal(SIGINT, on_stop_signal);
    std::signal(SIGTERM, on_stop_signal);
}

bool stop_asked() {
    return asked.load();
}

void ask_to_stop(bool stop) {
    asked.store(stop);
}

}  // namespace eti::client
