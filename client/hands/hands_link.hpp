// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string_view>
#include <thread>
#include <variant>

#include "client/hands/hand_playback.hpp"
#include "client/hands/hands.hpp"
#include "client/view/scene_view.hpp"
#include "common/bus/bus.hpp"
#include "common/process/threads/mailbox.hpp"
#include "common/process/threads/spsc_queue.hpp"

namespace eti::hands {

/// Writes a tool's pose to the bus unless another writer exists. An existing writer keeps the tool and this
/// one stops sending: a tool never has two hands.
class ToolWriter {
  public:
    /// `name`: of the tool, for the log.
    ToolWriter(bus::Node& node, const bus::Topic<msg::ToolPose>& topic, std::string_view name);

    /// Whether this writer currently owns the tool.
    [[nodiscard]] bool has_ownership();
    void write(const RigidTransform& pose, bool suction, std::uint64_t time_ns);
    [[nodiscard]] bool ownership_lost() const { return ownership_lost_; }
    [[nodiscard]] std::uint32_t written() const { return number_; }

  private:
    std::string_view name_;
    bus::Subscriber<msg::ToolPose> others_;
    std::optional<bus::Publisher<msg::ToolPose>> topic_;
    bool ownership_lost_ = false;
    std::uint32_t number_ = 0;
};

/// State of the hands, for a window or a report.
struct HandsState {
    bool holding = false;  ///< the session is present and its tools have been acquired
    Tool chosen = Tool::laryngoscope;
    std::array<bool, 2> owned{};           ///< by Tool: no other device writes its pose
    float held_back = 0.0f;                ///< of the chosen tool, 0: free, 1: fully blocked
    bool played = false;                   ///< a list was played to its end
    const render::View* view = nullptr;    ///< view chosen by the playback list
    std::array<std::uint32_t, 2> poses{};  ///< number written
};

/// Connects two hands to the session: a dedicated thread, independent of the frame rate, advances them in
/// simulation time and writes their poses at 240 Hz.
class HandsLink {
  public:
    HandsLink(bus::Node& node, std::optional<HandPlayback> play);
    ~HandsLink();
    HandsLink(const HandsLink&) = delete;
    HandsLink& operator=(const HandsLink&) = delete;

    /// The following from one thread. Events beyond max_events between two cycles are ignored.
    void press(char32_t key) { (void)events_.push(Press{key}); }
    void release(char32_t key) { (void)events_.push(Release{key}); }
    void drag(const HandDrag& drag) { (void)events_.push(drag); }
    [[nodiscard]] const HandsState& state() const { return newest_state_.newest(); }

  private:
    struct Press {
        char32_t key;
    };
    struct Release {
        char32_t key;
    };
    using Event = std::variant<Press, Release, HandDrag>;

    void run();
    void cycle();
    void receive_messages();

    bus::Subscriber<msg::SessionDescription> description_;
    bus::Subscriber<msg::ProxyState> proxy_;
    bus::Subscriber<msg::LiveMetrics> metrics_;
    bus::Subscriber<msg::TubeForce> tube_force_;
    ToolWriter blade_writer_, tube_writer_;

    // Used only by the thread.
    view::SceneView seen_;
    std::optional<Hands> hands_;
    std::optional<HandPlayback> play_;
    msg::SessionDescription description_message_;
    msg::ProxyState proxy_message_;
    msg::LiveMetrics metrics_message_;
    msg::TubeForce force_message_;
    Overtravel blade_overtravel_, tube_overtravel_;
    std::uint64_t time_ns_ = 0;
    int cycles_seen_ = 0;

    static constexpr std::size_t max_events = 1024;
    SpscQueue<Event> events_{max_events};
    mutable Mailbox<HandsState> newest_state_;
    std::atomic<bool> ending_{false};
    std::thread thread_;
};

}  // namespace eti::hands
