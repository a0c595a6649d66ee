// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "devices/sensor/sensor_monitor.hpp"
#include "tests/support/eventually.hpp"

namespace eti::devices {

using namespace std::chrono_literals;

/// The state that a stand-in library shares with the test. The driver loads the same file on its own.
template <class State>
[[nodiscard]] State& stand_in_state(const char* file, const char* function) {
    void* library = ::dlopen(file, RTLD_NOW);
    if (library == nullptr) {
        throw std::runtime_error(::dlerror());
    }
    return *reinterpret_cast<State* (*)()>(::dlsym(library, function))();
}

using test::eventually;

/// Exchanges with the device once a millisecond of wall time, as its loop would.
class Loop {
  public:
    explicit Loop(Sensor& device) : watch(device) {}

    Reading once() {
        std::this_thread::sleep_for(1ms);
        const auto now = std::chrono::steady_clock::now();
        const float elapsed = std::chrono::duration<float>(now - last_).count();
        last_ = now;
        watch.poll_events();
        return reading = watch.exchange(wrench, elapsed);
    }

    template <class Condition>
    [[nodiscard]] bool until(Condition condition, std::chrono::milliseconds limit = test::default_timeout) {
        const auto end = std::chrono::steady_clock::now() + limit;
        for (once(); !condition(); once()) {
            if (std::chrono::steady_clock::now() > end) {
                return false;
            }
        }
        return true;
    }

    void run_for(std::chrono::milliseconds time) {
        (void)until([] { return false; }, time);
    }

    SensorMonitor watch;
    Wrench wrench;
    Reading reading;

  private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace eti::devices
