// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <semaphore>
#include <span>
#include <thread>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/process/threads/mailbox.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::app {

/// Counters of the output for readers without skinning: states, for each of the two topics.
struct LabWork {
    std::atomic<std::uint64_t> frames_copied{0};  ///< by the physics thread, for surfaces
    std::atomic<std::uint64_t> particles_copied{0};
    std::atomic<std::uint64_t> surfaces_written{0};
    std::atomic<std::uint64_t> particles_written{0};
};

/// Publishes deformed surfaces and particles by tissue at 30 Hz from its own thread. Topics without readers
/// are neither copied nor computed. If publishing is slower than the simulation, states are dropped.
class LabOutput {
  public:
    /// `patient` must outlive it. `live`: the session runs in real time and other threads wait for the bus;
    /// the thread then writes with real-time priority.
    LabOutput(bus::Node& node, const patient::Patient& patient, bool live = false);
    ~LabOutput();
    LabOutput(const LabOutput&) = delete;
    LabOutput& operator=(const LabOutput&) = delete;

    /// Call once per step on the physics thread; never waits. `particles` [particles][m], in the patient's
    /// order.
    void post(const scene::Snapshot& snapshot, std::span<const Vec3f> particles);
    [[nodiscard]] const LabWork& work() const { return work_; }

  private:
    struct State {
        std::uint64_t step = 0;
        std::uint64_t time_ns = 0;
        std::vector<FramePose> frames;  // empty: surfaces have no reader
        std::vector<Vec3f> particles;   // empty: particles have no reader
    };

    void run();
    void poll_readers();
    void skin();
    void write_surfaces();
    void write_particles();
    /// Sends positions of one object or tissue in chunks; `message` holds the common fields.
    template <class Message>
    void write(std::span<const Vec3f> positions, Message& message, bus::Publisher<Message>& to);

    const patient::Patient& patient_;
    const bool live_;
    bus::Publisher<msg::MeshState> meshes_;
    bus::Publisher<msg::ParticleState> particles_;
    std::array<std::vector<std::uint32_t>, tissue_count> of_tissue_;  // particles by tissue

    std::atomic<bool> meshes_read_{false}, particles_read_{false};
    Mailbox<State> newest_;
    const State* current_ = nullptr;
    std::counting_semaphore<> posted_{0};
    LabWork work_;
    std::atomic<bool> ending_{false};

    std::vector<std::vector<Vec3f>> skinned_;  // [surfaces][vertices][m]
    std::vector<Vec3f> positions_;             // [m], of one tissue
    std::size_t burst_ = 0;                    // chunks sent so far
    std::thread thread_;
};

}  // namespace eti::app
