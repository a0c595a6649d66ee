// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/moment_queue.hpp"

#include <algorithm>
#include <iterator>

namespace eti::view {
namespace {

std::uint64_t distance(std::uint64_t a, std::uint64_t b) {
    return a > b ? a - b : b - a;
}

/// Number of messages, in order of arrival, to apply for the measures of `time_ns`: up to the last one that
/// is not later. Time falls back where a session restarts; measures of the end of the previous run do not
/// reach beyond, unless a shape of their time does. `before`: time of the last message applied.
template <class Queue>
std::size_t due(const Queue& queue, std::uint64_t time_ns, std::optional<std::uint64_t> before) {
    std::size_t count = 0;
    bool restarted = false;
    for (std::size_t i = 0; i < queue.size(); ++i) {
        const std::uint64_t time = queue[i].time_ns();
        restarted = restarted || (before && time + SceneView::restart_gap_ns < *before && *before <= time_ns);
        if (restarted ? time == time_ns : time <= time_ns) {
            count = i + 1;
        }
        before = time;
    }
    return count;
}

template <class Queue>
void apply_first(Queue& queue, std::size_t count, SceneView& scene) {
    const auto end = std::next(queue.begin(), static_cast<std::ptrdiff_t>(count));
    for (auto held = queue.begin(); held != end; ++held) {
        scene.apply(held->message);
    }
    queue.erase(queue.begin(), end);
}

}  // namespace

void MomentQueue::add(const msg::DeformationState& message, Clock::time_point now) {
    shapes_.push_back({message, now});
}

void MomentQueue::add(const msg::FluidState& message, Clock::time_point now) {
    liquid_.push_back({message, now});
}

void MomentQueue::add(const msg::ProxyState& message, Clock::time_point now) {
    proxies_.push_back({message, now});
}

void MomentQueue::add(const msg::LiveMetrics& message, Clock::time_point now) {
    measures_.push_back({message, now});
}

void MomentQueue::release_into(SceneView& scene, Clock::time_point now) {
    for (std::size_t i = measures_.size(); i > 0; --i) {
        const Held<msg::LiveMetrics>& held = measures_[i - 1];
        if (has_shape_of(held.time_ns()) || now - held.arrived >= longest_wait_for_shape) {
            advance_to(i - 1, scene);
            break;
        }
    }
    if (overdue(now)) {
        release_all(scene);
    }
}

bool MomentQueue::has_shape_of(std::uint64_t time_ns) const {
    return applied_shape_ns_ == time_ns || std::ranges::any_of(shapes_, [&](const auto& held) {
               return held.time_ns() == time_ns && held.message.chunk() + 1 == held.message.chunks();
           });
}

void MomentQueue::advance_to(std::size_t measures, SceneView& scene) {
    const std::uint64_t time_ns = measures_[measures].time_ns();
    const std::size_t shapes = due(shapes_, time_ns, applied_shape_ns_);
    const std::size_t liquid = due(liquid_, time_ns, applied_shape_ns_);
    if (shapes > 0) {
        applied_shape_ns_ = shapes_[shapes - 1].time_ns();
        apply_first(shapes_, shapes, scene);
    }
    apply_first(liquid_, liquid, scene);
    const auto nearest = std::ranges::min_element(
        proxies_, {}, [&](const auto& held) { return distance(held.time_ns(), time_ns); });
    if (nearest != proxies_.end()) {
        scene.apply(nearest->message);
        proxies_.erase(proxies_.begin(), nearest);  // itself may be nearest to the next moment, too
    }
    scene.apply(measures_[measures].message);
    measures_.erase(measures_.begin(),
                    std::next(measures_.begin(), static_cast<std::ptrdiff_t>(measures) + 1));
}

bool MomentQueue::overdue(Clock::time_point now) const {
    const auto old = [&](const auto& queue) {
        return queue.size() > capacity || (!queue.empty() && now - queue.front().arrived >= longest_hold);
    };
    // A proxy is kept after its use, so its age says nothing.
    return old(shapes_) || old(liquid_) || old(measures_) || proxies_.size() > capacity;
}

void MomentQueue::release_all(SceneView& scene) {
    if (!shapes_.empty()) {
        applied_shape_ns_ = shapes_.back().time_ns();
    }
    apply_first(shapes_, shapes_.size(), scene);
    apply_first(liquid_, liquid_.size(), scene);
    if (!proxies_.empty()) {
        scene.apply(proxies_.back().message);
        proxies_.erase(proxies_.begin(), std::prev(proxies_.end()));
    }
    apply_first(measures_, measures_.size(), scene);
}

}  // namespace eti::view
