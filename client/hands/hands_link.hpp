// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <variant>
#include <vector>

#include "client/hands/hand_play.hpp"
#include "client/hands/hands.hpp"
#include "client/view/scene_view.hpp"
#include "common/bus/bus.hpp"

namespace eti::client {

/// A tool's pose on the bus: written by these hands, unless somebody else writes it. Whoever is found there
/// keeps the tool, and no pose of ours is sent any more: a tool never has two hands.
class ToolWriter {
  public:
    /// `name`: of the tool, for the log.
    ToolWriter(bus::Node& node, const bus::Topic<msg::ToolPose>& topic, std::string_view name);

    /// Whether the tool is ours, as of now.
    [[nodiscard]] bool ours();
    void write(const RigidTransform& pose, bool suction, std::uint64_t time_ns);
    [[nodiscard]] bool given_up() const { return given_up_; }
    [[nodiscard]] std::uint32_t written() const { return number_; }

  private:
    std::string_view name_;
    bus::Subscriber<msg::ToolPose> others_;
    std::optional<bus::Publisher<msg::ToolPose>> topic_;
    bool given_up_ = false;
    std::uint32_t number_ = 0;
};

/// What a window or a report says of the hands.
struct HandsState {
    bool holding = false;  ///< the session is there and its tools have been taken
    Tool chosen = Tool::laryngoscope;
    std::array<bool, 2> ours{};  ///< by Tool: no other device writes its pose
    float held_back = 0.0f;      ///< of the chosen tool, 0 free to 1: it goes no farther
    bool played = false;         ///< a list is played, and has come to its end
    std::string play_step;
    const render::View* view = nullptr;    ///< that the list looks at
    std::array<std::uint32_t, 2> poses{};  ///< written
};

/// Carries two hands to the session: a thread of its own, which goes on however long a picture takes, lets
/// them move in simulation time and writes their poses at 240 Hz.
class HandsLink {
  public:
    HandsLink(bus::Node& node, std::optional<HandPlay> play);
    ~HandsLink();
    HandsLink(const HandsLink&) = delete;
    HandsLink& operator=(const HandsLink&) = delete;

    void press(char32_t key) { put(Press{key}); }
    void release(char32_t key) { put(Release{key}); }
    void drag(const HandDrag& drag) { put(drag); }
    [[nodiscard]] HandsState state() const;

  private:
    struct Press {
        char32_t key;
    };
    struct Release {
        char32_t key;
    };
    using Event = std::variant<Press, Release, HandDrag>;

    void put(const Event& event);
    void run();
    void cycle();
    void take_messages();

    bus::Subscriber<msg::SessionDescription> description_;
    bus::Subscriber<msg::ProxyState> proxy_;
    bus::Subscriber<msg::LiveMetrics> metrics_;
    bus::Subscriber<msg::TubeForce> tube_force_;
    ToolWriter blade_writer_, tube_writer_;

    // Of the thread.
    view::SceneView seen_;
    std::optional<Hands> hands_;
    std::optional<HandPlay> play_;
    msg::SessionDescription description_message_;
    msg::ProxyState proxy_message_;
    msg::LiveMetrics metrics_message_;
    msg::TubeForce force_message_;
    Lead blade_lead_, tube_lead_;
    std::uint64_t time_ns_ = 0;
    int cycles_seen_ = 0;

    mutable std::mutex mutex_;
    std::vector<Event> events_;
    HandsState state_;
    std::atomic<bool> ending_{false};
    std::thread thread_;
};

}  // namespace eti::client
