// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <atomic>
#include <deque>
#include <mutex>
#include <thread>

#include "common/bus/bus.hpp"
#include "common/math/random.hpp"
#include "common/process/threads/priority.hpp"
#include "devices/haptics/timing.hpp"
#include "tests/validation/haptics/closed_loop.hpp"

namespace eti::bench {

namespace msg = bus::msg;
using validation::Channel;

/// Forwards one topic from one session to another, with delay and loss.
template <class Message>
class TopicRelay {
  public:
    TopicRelay(bus::Node& from, bus::Node& to, const bus::Topic<Message>& topic)
        : in_(from, topic), out_(to, topic) {}

    /// Returns the lateness [ns], beyond its delay, of the last message forwarded in this turn.
    std::int64_t run(const Channel& channel, Random& random) {
        const std::int64_t now = devices::monotonic_ns();
        std::int64_t late_by = 0;
        Message message;
        while (in_.take(message)) {
            if (static_cast<double>(random.uniform()) >= channel.loss) {
                const double late =
                    0.5 * channel.delay + channel.jitter * static_cast<double>(random.uniform());
                waiting_.push_back({now + static_cast<std::int64_t>(1e9 * late), message});
            }
        }
        while (!waiting_.empty() && waiting_.front().first <= now) {
            late_by = std::max(late_by, now - waiting_.front().first);
            out_.publish(waiting_.front().second);
            waiting_.pop_front();
        }
        return late_by;
    }

  private:
    bus::Subscriber<Message> in_;
    bus::Publisher<Message> out_;
    std::deque<std::pair<std::int64_t, Message>> waiting_;
};

/// Stands between a server's session and a device's in place of a network: best-effort samples are delayed
/// and lost, reliable ones arrive complete. `device` has the server's name: nobody else's proxy is felt.
class Relay {
  public:
    Relay(const bus::Options& server, const bus::Options& device, const Channel& channel)
        : channel_(channel), server_(server), device_(device), thread_([this] { run(); }) {}
    ~Relay() {
        ending_ = true;
        thread_.join();
    }
    Relay(const Relay&) = delete;
    Relay& operator=(const Relay&) = delete;

    /// Applies from now on; messages in transit keep their delay. Resets the lateness.
    void set(const Channel& channel) {
        const std::lock_guard lock(mutex_);
        channel_ = channel;
        lateness_ = 0;
    }
    /// [s], maximum lateness of a message beyond its delay: the jitter of a busy machine.
    [[nodiscard]] double lateness() const {
        const std::lock_guard lock(mutex_);
        return 1e-9 * static_cast<double>(lateness_);
    }

  private:
    void run() {
        (void)set_real_time_priority(priority::step);
        Random random(1);
        TopicRelay<msg::ToolPose> pose(device_, server_, bus::topics::laryngoscope_pose);
        TopicRelay<msg::ProxyState> proxy(server_, device_, bus::topics::proxy);
        TopicRelay<msg::TissueContacts> tissue(server_, device_, bus::topics::tissue_contacts);
        TopicRelay<msg::LiveMetrics> live(server_, device_, bus::topics::live_metrics);
        TopicRelay<msg::SessionDescription> description(server_, device_, bus::topics::session_description);
        const Channel whole;
        while (!ending_) {
            std::this_thread::sleep_for(std::chrono::microseconds(250));
            Channel channel;
            {
                const std::lock_guard lock(mutex_);
                channel = channel_;
            }
            const std::int64_t late = std::max(
                {pose.run(channel, random), proxy.run(channel, random), tissue.run(channel, random)});
            (void)live.run(channel, random);
            (void)description.run(whole, random);
            const std::lock_guard lock(mutex_);
            lateness_ = std::max(lateness_, late);
        }
    }

    mutable std::mutex mutex_;
    Channel channel_;            // guarded by mutex_
    std::int64_t lateness_ = 0;  // [ns], guarded by mutex_
    bus::Node server_, device_;
    std::atomic<bool> ending_{false};
    std::thread thread_;
};

}  // namespace eti::bench
