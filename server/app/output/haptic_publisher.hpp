// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <semaphore>
#include <thread>

#include "common/bus/bus.hpp"
#include "common/process/threads/mailbox.hpp"
#include "server/app/output/scene_messages.hpp"

namespace eti::app {

/// Publishes haptic state from its own thread, each part as soon as the step has computed it. The physics
/// thread only posts copies and never waits, neither for the network nor for this thread. Newer states
/// replace unsent older ones.
class HapticPublisher {
  public:
    explicit HapticPublisher(bus::Node& node);
    ~HapticPublisher();
    HapticPublisher(const HapticPublisher&) = delete;
    HapticPublisher& operator=(const HapticPublisher&) = delete;

    void post_proxy(const scene::ProxySnapshot& proxy);
    /// Posts a proxy that is to be seen, not felt: its device is out of reach of any hand, so that a haptic
    /// device renders no force from it.
    void post_visible_proxy(const scene::ProxySnapshot& proxy);
    /// Posts the forces of tissue and tube, once the step is done.
    void post_forces(const scene::Snapshot& snapshot);
    /// Sends pending messages and ends the thread; later calls do nothing.
    void finish();
    /// Proxies replaced before they were sent. For the thread that posts them.
    [[nodiscard]] std::uint64_t skipped() const { return skipped_; }

  private:
    void run();
    void publish(const scene::ProxySnapshot& s);
    void publish(const HandForces& forces);

    bus::Publisher<msg::ProxyState> proxy_;
    bus::Publisher<msg::TissueContacts> contacts_;
    bus::Publisher<msg::TubeForce> tube_force_;

    Mailbox<scene::ProxySnapshot> newest_proxy_;
    Mailbox<HandForces> newest_forces_;
    std::counting_semaphore<> posted_{0};
    std::atomic<bool> ending_{false};
    std::uint64_t skipped_ = 0;
    std::thread thread_;
};

}  // namespace eti::app
