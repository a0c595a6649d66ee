// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/haptic_loop.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/bus/codec/convert.hpp"
#include "common/model/pace.hpp"
#include "common/process/threads/priority.hpp"

namespace eti::devices {

namespace {

constexpr float first_interval = 1e-3f;  // [s]
constexpr std::chrono::milliseconds publisher_timeout{50};

}  // namespace

double SimulationTime::at(const SceneState& scene, std::int64_t now) {
    const double age = static_cast<double>(now - scene.proxy_arrived) * 1e-9;
    const double carried = std::clamp(age * static_cast<double>(scene.pace), 0.0, 2.0 / steps_per_second);
    const double time = scene.seen.time + carried;
    last_ = scene.session == session_ ? std::max(last_, time) : time;
    session_ = scene.session;
    return last_;
}

HapticCycle::HapticCycle(Sensor& sensor, Mailbox<SceneState>& scene, const RenderSettings& settings)
    : sensor_(sensor), scene_(scene), renderer_(settings), device_(sensor.exchange({}, 0.0f)) {}

std::optional<OutgoingPose> HapticCycle::run(std::int64_t now, bool stop) {
    const std::int64_t started = monotonic_ns();
    const float elapsed = last_ == 0 ? first_interval : static_cast<float>(now - last_) * 1e-9f;
    if (last_ != 0) {
        record_.intervals.record(now - last_);
    }
    last_ = now;

    const SceneState* scene = nullptr;
    (void)scene_.read(scene);
    if (scene->proxy_arrived != 0) {
        seen_ = scene->seen;
        seen_.time = time_.at(*scene, now);
        sensor_.observe(seen_);
    }
    wrench_ = renderer_.cycle(device_.motion, *scene, now, elapsed);
    if (stop || !device_.present) {
        wrench_ = {};
        renderer_.release();
        record_.emergency_stop_cycles += stop ? 1 : 0;
        record_.absent_cycles += device_.present ? 0 : 1;
    }
    record_.computing.record(monotonic_ns() - started);
    device_ = sensor_.exchange(wrench_, elapsed);

    const float force = wrench_.force.norm();
    record_.force_sum += static_cast<double>(force);
    record_.force_max = std::max(record_.force_max, force);
    record_.stale_cycles += renderer_.stale() ? 1 : 0;
    record_.engaged_cycles += renderer_.engaged() ? 1 : 0;
    if (scene->proxy_arrived != 0) {
        if (record_.last_message != 0 && scene->proxy_arrived != record_.last_message) {
            record_.messages.record(scene->proxy_arrived - record_.last_message);
        }
        record_.last_message = scene->proxy_arrived;
    }
    record_.last_force = force > 0.0f ? now : record_.last_force;
    if (!device_.present) {
        return std::nullopt;
    }
    return OutgoingPose{device_.motion.pose, device_.buttons, static_cast<std::uint64_t>(seen_.time * 1e9)};
}

HapticLoop::HapticLoop(bus::Node& node, Sensor& sensor, Mailbox<SceneState>& scene,
                       const RenderSettings& settings)
    : sensor_(sensor),
      cycle_(sensor, scene, settings),
      topic_(node, settings.tool == Tool::tube ? bus::topics::tube_pose : bus::topics::laryngoscope_pose) {
    publisher_ = std::thread([this] { publish(); });
    on_servo_ = sensor_.start_servo(*this);
    if (on_servo_) {
        return;
    }
    std::binary_semaphore started{0};
    loop_ = std::thread([this, &started] {
        priority_refusal_ = set_real_time_priority(priority::loop);
        started.release();
        run();
    });
    started.acquire();
}

HapticLoop::~HapticLoop() {
    stop();
}

void HapticLoop::stop() {
    ending_.store(true, std::memory_order_relaxed);
    if (publisher_.joinable()) {
        if (on_servo_) {
            sensor_.stop_servo();
        } else {
            loop_.join();
        }
        publisher_.join();
        (void)sensor_.exchange({}, first_interval);
    }
}

void HapticLoop::run() {
    std::int64_t next = monotonic_ns();
    while (!ending_.load(std::memory_order_relaxed)) {
        sleep_until_ns(next);
        const std::int64_t now = monotonic_ns();
        if (now < next) {
            continue;  // woken early by a signal
        }
        cycle(now);
        // Missed cycles are not repeated: the device has moved.
        next += period_ns * (1 + (now - next) / period_ns);
    }
}

void HapticLoop::cycle(std::int64_t now) {
    if (const auto pose = cycle_.run(now, emergency_stop_.load(std::memory_order_relaxed))) {
        outgoing_.write(*pose);
        posted_.release();
    }
    force_.store(cycle_.wrench().force.norm(), std::memory_order_relaxed);
    cycles_.fetch_add(1, std::memory_order_relaxed);
}

void HapticLoop::servo_cycle() noexcept {
    cycle(monotonic_ns());
}

void HapticLoop::publish() {
    (void)set_real_time_priority(priority::bus);
    msg::ToolPose message;
    const OutgoingPose* pose = nullptr;
    while (!ending_.load(std::memory_order_relaxed)) {
        if (!posted_.try_acquire_for(publisher_timeout) || !outgoing_.read(pose)) {
            continue;
        }
        message.header(bus::make_header(pose->simulation_ns, static_cast<std::uint32_t>(published_)));
        message.pose(bus::to_msg(pose->pose));
        message.buttons(pose->buttons);
        published_ += topic_.publish(message) ? 1 : 0;
    }
}

}  // namespace eti::devices
