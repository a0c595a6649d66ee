// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <mutex>
#include <optional>
#include <thread>

#include "common/bus/bus.hpp"
#include "common/bus/session_keys.hpp"
#include "devices/haptics/scene_state.hpp"
#include "devices/sensor/triple_buffer.hpp"

namespace eti::devices {

/// What a scripted hand needs before it can begin.
struct Surroundings {
    Observation seen;
    float blade_length = 0.0f;    ///< [m]
    float grip_to_tip = 0.0f;     ///< [m], of the tube
    float tube_curvature = 0.0f;  ///< [1/m]
};

/// Follows the server over the bus on a thread of its own and leaves the newest scene in a triple
/// buffer for the device's loop. Messages are checked here: what is not finite is dropped and counted; of
/// proxy, tissue and tube, what came before it counts no more, so that its force ends at once.
class SceneLink {
  public:
    /// What of the scene a device needs besides the proxy.
    enum class Feel : std::uint8_t { nothing, tissue, tube };
    SceneLink(bus::Node& node, Feel feel);
    ~SceneLink();
    SceneLink(const SceneLink&) = delete;
    SceneLink& operator=(const SceneLink&) = delete;

    /// For the one thread that runs the device's loop.
    [[nodiscard]] TripleBuffer<SceneState>& newest() { return newest_; }

    /// Known once the scene's tools and a first set of landmarks have come.
    [[nodiscard]] std::optional<Surroundings> surroundings() const;
    [[nodiscard]] bool finished() const { return finished_.load(std::memory_order_relaxed); }
    [[nodiscard]] std::uint64_t received() const { return received_.load(std::memory_order_relaxed); }
    [[nodiscard]] std::uint64_t refused() const { return refused_.load(std::memory_order_relaxed); }
    [[nodiscard]] std::uint64_t outages() const { return outages_.load(std::memory_order_relaxed); }

  private:
    void run();
    /// Counts a message that is not to be believed and forgets when the last one `arrived`; true: this
    /// changed.
    bool refuse(std::int64_t& arrived);
    /// Where two claim to be the server, what came counts no more; true: this changed.
    bool doubt();
    bool take_proxy();
    bool take_tissue();
    bool take_tube();
    bool take_live();
    void take_description();
    void take_status();
    void watch_silence(std::int64_t now);
    void measure_pace(std::uint64_t simulation_ns, std::int64_t now);

    bus::Node& node_;
    bus::Bell bell_;
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

    std::optional<bus::SessionKeys> keys_;  // once the session has described itself
    SceneState state_;
    std::uint64_t simulation_ns_ = 0;  // of the last ProxyState
    // Where the measurement of the pace began.
    std::uint64_t pace_simulation_ns_ = 0;
    std::int64_t pace_arrived_ = 0;
    std::int64_t heard_ = 0;  // arrival of the last ProxyState [ns, CLOCK_MONOTONIC]
    bool silent_ = false, frozen_ = false;
    TripleBuffer<SceneState> newest_;

    mutable std::mutex mutex_;  // guards what follows, read at start-up only
    Surroundings surroundings_;
    bool seen_landmarks_ = false;

    std::atomic<bool> ending_{false}, finished_{false};
    std::atomic<std::uint64_t> received_{0}, refused_{0}, outages_{0};
    std::thread thread_;
};

}  // namespace eti::devices
