// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>

#include "client/view/scene_view.hpp"

namespace eti::view {

/// Holds messages back until a SceneView can advance to one moment of simulation time. Shape, tools and
/// measures travel on separate topics, and the measures of a step are known only after its shape was sent;
/// applied as they arrive, the newest of each belong to different steps. A moment is the time of a
/// LiveMetrics message: deformation and liquid up to it are applied, the laryngoscope's pose nearest to it,
/// then the measures. Adds the assessment's delay; meant for pictures that are kept. Single-threaded.
class MomentQueue {
  public:
    using Clock = std::chrono::steady_clock;
    /// Wait for a shape of exactly the measures' time: it may be lost, or a busy server may have skipped it.
    static constexpr std::chrono::milliseconds longest_wait_for_shape{300};
    /// Age at which a message is applied although no measures follow it.
    static constexpr std::chrono::milliseconds longest_hold{2000};
    /// Messages held; 45 seconds of deformation.
    static constexpr std::size_t capacity = 4096;

    void add(const msg::DeformationState& message, Clock::time_point now);
    void add(const msg::FluidState& message, Clock::time_point now);
    void add(const msg::ProxyState& message, Clock::time_point now);
    void add(const msg::LiveMetrics& message, Clock::time_point now);

    /// Advances `scene` to the newest complete moment, if there is one.
    void release_into(SceneView& scene, Clock::time_point now);

  private:
    template <class Message>
    struct Held {
        Message message;
        Clock::time_point arrived;
        [[nodiscard]] std::uint64_t time_ns() const { return message.header().simulation_time_ns(); }
    };
    template <class Message>
    using Queue = std::deque<Held<Message>>;

    [[nodiscard]] bool has_shape_of(std::uint64_t time_ns) const;
    void advance_to(std::size_t measures, SceneView& scene);
    void release_all(SceneView& scene);
    [[nodiscard]] bool overdue(Clock::time_point now) const;

    Queue<msg::DeformationState> shapes_;
    Queue<msg::FluidState> liquid_;
    Queue<msg::ProxyState> proxies_;
    Queue<msg::LiveMetrics> measures_;
    std::optional<std::uint64_t> applied_shape_ns_;
};

}  // namespace eti::view
