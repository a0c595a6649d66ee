// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/app/sampling.hpp"

#include <utility>

#include "devices/haptics/timing.hpp"

namespace eti::devices {

namespace {

constexpr std::int64_t period_ns = 4'000'000;

}  // namespace

ServoReading::~ServoReading() {
    if (on_servo_) {
        watch_.stop_servo();
    }
}

void ServoReading::servo_cycle() noexcept {
    const std::int64_t now = monotonic_ns();
    newest_.write(watch_.exchange({}, last_ == 0 ? 0.0f : static_cast<float>(now - last_) * 1e-9f));
    last_ = now;
}

bool ServoReading::newest(Reading& reading) {
    const Reading* found = nullptr;
    const bool fresh = newest_.read(found);
    reading = *found;
    return fresh && reading.present;
}

Sampling::Sampling(std::unique_ptr<Sensor> device)
    : device_(std::move(device)), watch_(*device_), reading_(watch_) {
    if (!reading_.on_servo()) {
        thread_ = std::thread([this] {
            while (!ending_.load(std::memory_order_relaxed)) {
                sleep_until_ns(monotonic_ns() + period_ns);
                reading_.read();
            }
        });
    }
}

Sampling::~Sampling() {
    ending_.store(true, std::memory_order_relaxed);
    if (thread_.joinable()) {
        thread_.join();
    }
}

}  // namespace eti::devices
