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

/// Publishes what hands feel, from a thread of its own: each part leaves as soon as the step has it. The
/// physics thread only leaves copies here and never waits for the network. A state that a newer one overtakes
/// is replaced.
class FeltOutput {
  public:
    explicit FeltOutput(bus::Node& node);
    ~FeltOutput();
    FeltOutput(const FeltOutput&) = delete;
    FeltOutput& operator=(const FeltOutput&) = delete;

    void post_proxy(const scene::ProxySnapshot& proxy);
    /// The forces of tissue and tube, once the step is done.
    void post_forces(const scene::Snapshot& snapshot);
    /// Sends what waits and ends the thread; later calls do nothing.
    void finish();
    [[nodiscard]] std::uint64_t skipped() const;  ///< proxies replaced before they were sent

  private:
    /// Of a snapshot, what becomes messages.
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
