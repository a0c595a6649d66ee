// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "common/bus/bus.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::app {

/// What was done for readers that do not skin: states, for each of the two topics.
struct LabWork {
    std::uint64_t frames_copied = 0;  ///< by the physics thread, for the surfaces
    std::uint64_t particles_copied = 0;
    std::uint64_t surfaces_written = 0;
    std::uint64_t particles_written = 0;
};

/// Publishes deformed surfaces and particles by tissue, 30 times a second, from its own thread. What nobody
/// reads is neither copied nor computed. When publishing is slower than the simulation, states are left out.
class LabOutput {
  public:
    /// `patient` has to outlive it. `live`: others wait for the bus, by the clock.
    LabOutput(bus::Node& node, const anatomy::Patient& patient, bool live = false);
    ~LabOutput();
    LabOutput(const LabOutput&) = delete;
    LabOutput& operator=(const LabOutput&) = delete;

    /// Of each step, on the physics thread; never waits. `particles`: positions [m], in the patient's order.
    void post(const scene::Snapshot& snapshot, std::span<const Vec3f> particles);
    [[nodiscard]] LabWork work() const;

  private:
    struct State {
        std::uint64_t step = 0;
        std::uint64_t time_ns = 0;
        std::vector<FramePose> frames;  // empty: nobody reads the surfaces
        std::vector<Vec3f> particles;   // likewise
        bool fresh = false;
    };

    void run();
    void look_for_readers();
    void skin();
    void write_surfaces();
    void write_particles();
    /// Chunks of one object's or one tissue's positions; `message` holds what they have in common.
    template <class Message>
    void write(std::span<const Vec3f> positions, Message& message, bus::Publisher<Message>& to);

    const anatomy::Patient& patient_;
    const bool live_;
    bus::Publisher<msg::MeshState> meshes_;
    bus::Publisher<msg::ParticleState> particles_;
    std::array<std::vector<std::uint32_t>, tissue_count> of_tissue_;  // particles

    std::atomic<bool> meshes_read_{false}, particles_read_{false};
    mutable std::mutex mutex_;
    std::condition_variable wake_;
    State waiting_, current_;
    LabWork work_;
    bool ending_ = false;

    std::vector<std::vector<Vec3f>> skinned_;  // by surface [m]
    std::vector<Vec3f> positions_;             // of one tissue [m]
    std::size_t burst_ = 0;                    // chunks so far
    std::thread thread_;
};

}  // namespace eti::app
