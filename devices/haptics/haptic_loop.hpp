// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <optional>
#include <semaphore>
#include <string>
#include <thread>

#include "common/bus/bus.hpp"
#include "common/process/threads/mailbox.hpp"
#include "devices/haptics/force_renderer.hpp"
#include "devices/haptics/timing.hpp"
#include "devices/sensor/sensor.hpp"

namespace eti::devices {

/// A device's pose on its way to the bus.
struct OutgoingPose {
    RigidTransform pose;
    std::uint32_t buttons = 0;
    std::uint64_t simulation_ns = 0;
};

/// Simulation time now: the time of the last message, extrapolated at the simulation's pace for at most two
/// steps. Never decreases within a session.
class SimulationTime {
  public:
    [[nodiscard]] double at(const SceneState& scene, std::int64_t now);

  private:
    double last_ = 0.0;
    std::uint32_t session_ = 0;
};

/// Statistics of the cycles; written by the loop's thread, read after it has ended.
struct HapticRecord {
    CycleStatistics intervals;
    CycleStatistics computing;         // time that a cycle took, without the exchange with the device
    CycleStatistics messages{50'000};  // between arrivals of successive messages, as cycles saw them
    double force_sum = 0.0;            // [N], over cycles
    float force_max = 0.0f;            // [N]
    std::uint64_t stale_cycles = 0;    // with reduced force for lack of messages
    std::uint64_t engaged_cycles = 0;
    std::uint64_t absent_cycles = 0;          // without a present device
    std::uint64_t emergency_stop_cycles = 0;  // during an emergency stop
    std::int64_t last_message = 0;            // [ns], arrival of the newest ProxyState that a cycle saw
    std::int64_t last_force = 0;              // [ns], newest cycle with a non-zero force
};

/// One cycle of the 1 kHz loop: read the newest scene, pass the observation to the device, render the force,
/// exchange it for the device's pose, and leave the pose for the bus. Needs no thread and reads no clock.
class HapticCycle {
  public:
    HapticCycle(Sensor& sensor, Mailbox<SceneState>& scene, const RenderSettings& settings);

    /// `now` [ns, CLOCK_MONOTONIC], non-decreasing. `stop`: zero force regardless of the scene. Returns the
    /// pose to publish; nullopt while no device is present.
    std::optional<OutgoingPose> run(std::int64_t now, bool stop = false);

    [[nodiscard]] const Wrench& wrench() const { return wrench_; }
    [[nodiscard]] const HapticRecord& record() const { return record_; }
    [[nodiscard]] const ForceRenderer& renderer() const { return renderer_; }

  private:
    Sensor& sensor_;
    Mailbox<SceneState>& scene_;
    ForceRenderer renderer_;
    SimulationTime time_;
    Observation seen_;
    Reading device_;
    Wrench wrench_;
    std::int64_t last_ = 0;
    HapticRecord record_;
};

/// Runs the cycle at 1 kHz on its own thread, or on the device's servo thread if it has one, and publishes
/// poses on another thread.
///
/// A DDS write takes locks and a system call and may take milliseconds on a loaded machine, so it must not
/// run in the loop. The loop leaves the pose in a mailbox and posts a semaphore, which never blocks.
/// The second thread, of lower priority, wakes on it, so poses are published without added delay. When
/// publishing is slow, poses are skipped, not queued.
class HapticLoop final : private ServoCycle {
  public:
    static constexpr std::int64_t period_ns = 1'000'000;

    HapticLoop(bus::Node& node, Sensor& sensor, Mailbox<SceneState>& scene, const RenderSettings& settings);
    ~HapticLoop() override;
    HapticLoop(const HapticLoop&) = delete;
    HapticLoop& operator=(const HapticLoop&) = delete;

    void stop();  ///< ends both threads; the last wrench sent to the device is zero

    /// Removes the force from the next cycle until called with false; force then re-engages after quiet
    /// cycles and by the ramp.
    void set_emergency_stop(bool off) { emergency_stop_.store(off, std::memory_order_relaxed); }

    /// Current force on the hand [N].
    [[nodiscard]] float force() const { return force_.load(std::memory_order_relaxed); }
    /// Cycles so far; a watchdog checks that the number increases.
    [[nodiscard]] std::uint64_t cycles() const { return cycles_.load(std::memory_order_relaxed); }
    /// Call after stop().
    [[nodiscard]] const HapticCycle& cycle() const { return cycle_; }
    [[nodiscard]] std::uint64_t published() const { return published_; }
    /// Whether the device's own thread runs the cycle.
    [[nodiscard]] bool on_servo() const { return on_servo_; }
    /// Why the loop has no real-time priority; empty if it has one, or if the thread is the device's.
    [[nodiscard]] const std::string& priority_refusal() const { return priority_refusal_; }

  private:
    void servo_cycle() noexcept override;
    void cycle(std::int64_t now);
    void run();
    void publish();

    Sensor& sensor_;
    HapticCycle cycle_;
    bus::Publisher<msg::ToolPose> topic_;
    Mailbox<OutgoingPose> outgoing_;
    std::counting_semaphore<> posted_{0};
    std::atomic<bool> ending_{false}, emergency_stop_{false};
    std::atomic<float> force_{0.0f};
    std::atomic<std::uint64_t> cycles_{0};
    bool on_servo_ = false;
    std::string priority_refusal_;
    std::uint64_t published_ = 0;
    std::thread publisher_, loop_;
};

}  // namespace eti::devices
