// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <optional>
#include <thread>

#include "common/bus/bus.hpp"
#include "common/bus/security/session_keys.hpp"
#include "common/process/threads/mailbox.hpp"
#include "devices/haptics/scene_state.hpp"

namespace eti::devices {

/// Scene data that a scripted hand needs to start.
struct InitialScene {
    Observation seen;
    float blade_length = 0.0f;    ///< [m]
    float grip_to_tip = 0.0f;     ///< [m], of the tube
    float tube_curvature = 0.0f;  ///< [1/m]
};

/// Receives the server's messages on its own thread and leaves the newest scene in a mailbox for the
/// device's loop. Non-finite messages are dropped and counted. For proxy, tissue and tube, such a message
/// also invalidates earlier ones, so that their force ends at once.
class SceneLink {
  public:
    /// Source of force that a device needs besides the proxy.
    enum class ForceSource : std::uint8_t { nothing, tissue, tube };
    SceneLink(bus::Node& node, ForceSource feel);
    ~SceneLink();
    SceneLink(const SceneLink&) = delete;
    SceneLink& operator=(const SceneLink&) = delete;

    /// For the thread that runs the device's loop.
    [[nodiscard]] Mailbox<SceneState>& newest() { return newest_; }

    /// Known once the scene's tools and a first set of landmarks have arrived. Call from one thread.
    [[nodiscard]] const std::optional<InitialScene>& initial_scene() const { return known_scene_.newest(); }
    [[nodiscard]] bool finished() const { return finished_.load(std::memory_order_relaxed); }
    [[nodiscard]] std::uint64_t received() const { return received_.load(std::memory_order_relaxed); }
    [[nodiscard]] std::uint64_t refused() const { return refused_.load(std::memory_order_relaxed); }
    [[nodiscard]] std::uint64_t outages() const { return outages_.load(std::memory_order_relaxed); }

  private:
    void run();
    /// Counts an invalid message and clears the arrival time `arrived` of the last one; true if that changed
    /// it.
    bool refuse(std::int64_t& arrived);
    /// Discards received data while two participants claim to be the server; true if that changed anything.
    bool discard_if_contested();
    bool take_proxy();
    bool take_tissue();
    bool take_tube();
    bool take_live();
    void take_description();
    void take_status();
    void post_initial_scene();
    void watch_silence(std::int64_t now);
    void measure_real_time_factor(std::uint64_t simulation_ns, std::int64_t now);

    bus::Node& node_;
    bus::WaitSet wait_set_;
    bus::Subscriber<msg::ProxyState> proxy_topic_;
    std::optional<bus::Subscriber<msg::TissueContacts>> tissue_topic_;
    std::optional<bus::Subscriber<msg::TubeForce>> tube_topic_;
    bus::Subscriber<msg::LiveMetrics> live_topic_;
    bus::Subscriber<msg::SessionDescription> description_topic_;
    bus::Subscriber<msg::SessionStatus> status_topic_;
    msg::ProxyState proxy_;
    msg::TissueContacts tissue_;
    msg::TubeForce tube_;
    msg::LiveMetrics live_;
    msg::SessionDescription description_;
    msg::SessionStatus status_;

    std::optional<bus::SessionKeys> keys_;  // once the description has arrived
    SceneState state_;
    std::uint64_t simulation_ns_ = 0;  // of the last ProxyState
    // Start of the measurement of the pace.
    std::uint64_t pace_simulation_ns_ = 0;
    std::int64_t pace_arrived_ = 0;
    std::int64_t heard_ = 0;  // arrival of the last ProxyState [ns, CLOCK_MONOTONIC]
    bool silent_ = false, frozen_ = false;
    Mailbox<SceneState> newest_;

    InitialScene initial_scene_;
    bool seen_landmarks_ = false;
    mutable Mailbox<std::optional<InitialScene>> known_scene_;

    std::atomic<bool> ending_{false}, finished_{false};
    std::atomic<std::uint64_t> received_{0}, refused_{0}, outages_{0};
    std::thread thread_;
};

}  // namespace eti::devices
