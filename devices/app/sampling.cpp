// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/app/sampling.hpp"

#include <utility>

#include "devices/haptics/timing.hpp"

namespace eti::devices {

namespace {

constexpr std::int64_t period_ns = 4'000'000;

}  // namespace

Sampling::Sampling(std::unique_ptr<Sensor> device) : device_(std::move(device)), watch_(*device_) {
    on_servo_ = watch_.start_servo(*this);
    if (!on_servo_) {
        thread_ = std::thread([this] {
            while (!ending_.load(std::memory_order_relaxed)) {
                sleep_until_ns(monotonic_ns() + period_ns);
                servo_cycle();
            }
        });
    }
}

Sampling::~Sampling() {
    if (on_servo_) {
        watch_.stop_servo();
    } else {
        ending_.store(true, std::memory_order_relaxed);
        thread_.join();
    }
}

void Sampling::servo_cycle() noexcept {
    const std::int64_t now = monotonic_ns();
    newest_.write(watch_.exchange({}, last_ == 0 ? 0.0f : static_cast<float>(now - last_) * 1e-9f));
    last_ = now;
}

bool Sampling::newest(Reading& reading) {
    const Reading* found = nullptr;
    const bool fresh = newest_.read(found);
    reading = *found;
    return fresh && reading.present;
}

}  // namespace eti::devices
