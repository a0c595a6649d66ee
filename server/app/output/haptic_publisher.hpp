// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::app {

/// Publishes haptic state from its own thread, each part as soon as the step has computed it. The physics
/// thread only posts copies and never waits for the network. Newer states replace unsent older ones.
class HapticPublisher {
  public:
    explicit HapticPublisher(bus::Node& node);
    ~HapticPublisher();
    HapticPublisher(const HapticPublisher&) = delete;
    HapticPublisher& operator=(const HapticPublisher&) = delete;

    void post_proxy(const scene::ProxySnapshot& proxy);
    /// Posts the forces of tissue and tube, once the step is done.
    void post_forces(const scene::Snapshot& snapshot);
    /// Sends pending messages and ends the thread; later calls do nothing.
    void finish();
    [[nodiscard]] std::uint64_t skipped() const;  ///< proxies replaced before they were sent

  private:
    /// The parts of a snapshot that are sent.
    struct Forces {
        std::uint64_t step = 0, time_ns = 0;
        RigidTransform proxy;
        Vec3f tissue_force, tissue_torque, tube_force, tube_torque;
        std::vector<scene::TissueContact> contacts;
    };

    void run();
    void publish(const scene::ProxySnapshot& s);
    void publish(const Forces& s);

    bus::Publisher<msg::ProxyState> proxy_;
    bus::Publisher<msg::TissueContacts> contacts_;
    bus::Publisher<msg::TubeForce> tube_force_;

    mutable std::mutex mutex_;
    std::condition_variable wake_;
    scene::ProxySnapshot waiting_proxy_, sent_proxy_;
    Forces waiting_forces_, sent_forces_;
    bool fresh_proxy_ = false, fresh_forces_ = false, ending_ = false;
    std::uint64_t skipped_ = 0;
    std::thread thread_;
};

}  // namespace eti::app
