// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/output/lab_output.hpp"

#include <algorithm>
#include <chrono>

#include "common/bus/codec/convert.hpp"
#include "common/bus/codec/quantised_positions.hpp"
#include "common/model/pace.hpp"
#include "common/process/threads/priority.hpp"

namespace eti::app {

namespace {

constexpr std::uint64_t steps_per_lab_state = steps_per_second / 30;
// Maximum wait of a new reader for its first state, in addition to the period of states.
constexpr std::chrono::milliseconds reader_poll_period{100};
// A state of 400 kB sent at once overflows the default socket buffer of a reader (208 kB, less than a hundred
// of these datagrams). Bursts of this size leave it half empty and still give 40 MB/s.
constexpr std::size_t burst_chunks = 40;
constexpr std::chrono::milliseconds rest_after_burst{1};

}  // namespace

LabOutput::LabOutput(bus::Node& node, const patient::Patient& patient, bool live)
    : patient_(patient),
      live_(live),
      meshes_(node, bus::topics::mesh_state),
      particles_(node, bus::topics::particle_state),
      skinned_(patient.surfaces.size()) {
    for (std::uint32_t i = 0; i < patient.particles.size(); ++i) {
        of_tissue_[static_cast<std::size_t>(patient.particles.tissue[i])].push_back(i);
    }
    thread_ = std::thread([this] { run(); });
}

LabOutput::~LabOutput() {
    ending_.store(true, std::memory_order_relaxed);
    posted_.release();
    thread_.join();
}

void LabOutput::post(const scene::Snapshot& snapshot, std::span<const Vec3f> particles) {
    const bool meshes = meshes_read_.load(std::memory_order_relaxed);
    const bool points = particles_read_.load(std::memory_order_relaxed);
    if (snapshot.step % steps_per_lab_state != 0 || !(meshes || points)) {
        return;
    }
    State& state = newest_.draft();
    state.step = snapshot.step;
    state.time_ns = snapshot.time_ns;
    state.frames.clear();
    state.particles.clear();
    if (meshes) {
        state.frames = snapshot.frames;
        ++work_.frames_copied;
    }
    if (points) {
        state.particles.assign(particles.begin(), particles.end());
        ++work_.particles_copied;
    }
    newest_.post();
    posted_.release();
}

void LabOutput::run() {
    // At normal priority the thread could be preempted while it holds the bus's locks, which would delay
    // haptics.
    const auto before_others = [&] {
        if (live_) {
            (void)set_real_time_priority(priority::step);
        }
    };
    before_others();
    for (;;) {
        (void)posted_.try_acquire_for(reader_poll_period);
        if (ending_.load(std::memory_order_relaxed)) {
            return;
        }
        poll_readers();
        if (!newest_.read(current_)) {
            continue;
        }
        if (meshes_read_ && !current_->frames.empty()) {
            if (live_) {
                reset_priority();
            }
            skin();
            before_others();
            write_surfaces();
        }
        if (particles_read_ && !current_->particles.empty()) {
            write_particles();
        }
    }
}

void LabOutput::poll_readers() {
    meshes_read_ = meshes_.matched() > 0;
    particles_read_ = particles_.matched() > 0;
}

void LabOutput::skin() {
    std::vector<FrameMap> maps;
    for (std::size_t f = 0; f < current_->frames.size(); ++f) {
        maps.push_back(frame_map(current_->frames[f], patient_.frame_rest_centre[f]));
    }
    for (std::size_t s = 0; s < patient_.surfaces.size(); ++s) {
        const Surface& surface = patient_.surfaces[s];
        skinned_[s].resize(surface.mesh.vertices.size());
        for (std::size_t v = 0; v < skinned_[s].size(); ++v) {
            skinned_[s][v] = skin_point(surface.mesh.vertices[v], surface.skin[v], maps);
        }
    }
}

void LabOutput::write_surfaces() {
    std::size_t chunks = 0;
    for (const std::vector<Vec3f>& vertices : skinned_) {
        chunks += bus::chunk_count(vertices.size());
    }
    msg::MeshState message;
    message.header(bus::make_header(current_->time_ns, static_cast<std::uint32_t>(current_->step)));
    message.chunks(static_cast<std::uint16_t>(chunks));
    for (std::size_t s = 0; s < skinned_.size(); ++s) {
        message.object(patient_.surfaces[s].name);
        write(skinned_[s], message, meshes_);
    }
    ++work_.surfaces_written;
}

void LabOutput::write_particles() {
    std::size_t chunks = 0;
    for (const auto& particles : of_tissue_) {
        chunks += bus::chunk_count(particles.size());
    }
    msg::ParticleState message;
    message.header(bus::make_header(current_->time_ns, static_cast<std::uint32_t>(current_->step)));
    message.chunks(static_cast<std::uint16_t>(chunks));
    for (std::size_t tissue = 0; tissue < tissue_count; ++tissue) {
        positions_.clear();
        for (const std::uint32_t particle : of_tissue_[tissue]) {
            positions_.push_back(current_->particles[particle]);
        }
        message.tissue(static_cast<std::uint32_t>(tissue));
        message.count(static_cast<std::uint32_t>(positions_.size()));
        write(positions_, message, particles_);
    }
    ++work_.particles_written;
}

template <class Message>
void LabOutput::write(std::span<const Vec3f> positions, Message& message, bus::Publisher<Message>& to) {
    for (std::size_t first = 0; first < positions.size(); first += bus::chunk_positions) {
        const auto part = positions.subspan(first, std::min(bus::chunk_positions, positions.size() - first));
        message.first(static_cast<std::uint32_t>(first));
        bus::encode_positions(bus::box_around(part), part, message);
        to.publish(message);
        message.chunk(static_cast<std::uint16_t>(message.chunk() + 1));
        if (++burst_ % burst_chunks == 0) {
            std::this_thread::sleep_for(rest_after_burst);
        }
    }
}

}  // namespace eti::app
