// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/output/lab_output.hpp"

#include <map>
#include <optional>

#include "common/bus/codec/quantised_positions.hpp"
#include "common/math/random.hpp"
#include "tests/unit/common/bus/bus_fixture.hpp"

namespace eti::app {
namespace {

using bus::eventually;
using std::chrono_literals::operator""ms;

constexpr std::size_t most_vertices = 3 * bus::chunk_positions + 5;

/// Three frames, two surfaces of several chunks, particles of two alternating tissues.
patient::Patient patient_of_two_surfaces() {
    Random random(3);
    const auto length = [&] { return 0.1f * random.uniform(); };
    const auto point = [&] { return Vec3f(length(), length(), length()); };
    patient::Patient patient;
    patient.frame_rest_centre = {point(), point(), point()};
    for (const auto& [name, vertices] : {std::pair{"face", most_vertices}, {"tongue", std::size_t{40}}}) {
        Surface& surface = patient.surfaces.emplace_back();
        surface.name = name;
        for (std::size_t v = 0; v < vertices; ++v) {
            surface.mesh.vertices.push_back(point());
            const float share = random.uniform();
            surface.skin.push_back(
                {{static_cast<std::uint16_t>(v % 3), static_cast<std::uint16_t>((v + 1) % 3), 0, 0},
                 {share, 1.0f - share, 0.0f, 0.0f}});
        }
    }
    for (std::size_t i = 0; i < 500; ++i) {
        patient.particles.rest.push_back(point());
        patient.particles.tissue.push_back(i % 5 == 0 ? Tissue::epiglottis : Tissue::tongue);
    }
    return patient;
}

class LabOutputTest : public ::testing::Test {
  protected:
    LabOutputTest()
        : server_(bus::options("eti-server")),
          client_(bus::options("client")),
          patient_(patient_of_two_surfaces()),
          output_(server_, patient_) {
        snapshot_.frames.resize(3);
        snapshot_.frames[0] = {Vec3f(0.01f, 0.02f, 0.03f), Quatf(0.8f, 0.6f, 0.0f, 0.0f)};
        snapshot_.frames[2].centre = Vec3f(-0.02f, 0.0f, 0.05f);
    }

    void step() {
        ++snapshot_.step;
        snapshot_.time_ns += 5'555'555;
        output_.post(snapshot_, patient_.particles.rest);
    }

    void steps(int count) {
        for (int i = 0; i < count; ++i) {
            step();
            std::this_thread::sleep_for(5ms);
        }
    }

    /// Steps until all chunks of one state have arrived, and returns them by chunk.
    template <class Message>
    std::map<int, Message> whole_state(bus::Subscriber<Message>& reader) {
        std::map<std::uint32_t, std::map<int, Message>> states;
        std::map<int, Message> whole;
        EXPECT_TRUE(eventually([&] {
            steps(1);
            for (Message message; reader.take(message);) {
                auto& state = states[message.header().number()];
                state[message.chunk()] = message;
                if (state.size() == message.chunks()) {
                    whole = state;
                }
            }
            return !whole.empty();
        }));
        return whole;
    }

    bus::Node server_, client_;
    patient::Patient patient_;
    LabOutput output_;
    scene::Snapshot snapshot_;
};

/// Half a quantum of the chunk's box, and the rounding of floats of up to 0.3 m.
template <class Message>
Vec3f bound(const Message& message) {
    return (bus::from_msg(message.upper()) - bus::from_msg(message.lower())) / 131070.0f +
           Vec3f::Constant(0.3f * 0x1p-23f);
}

TEST_F(LabOutputTest, UnsubscribedTopicsAreNotComputed) {
    // Readers of other topics do not count.
    bus::Subscriber<msg::DeformationState> other(client_, bus::topics::deformation);
    steps(60);
    const LabWork& work = output_.work();
    EXPECT_EQ(work.frames_copied + work.particles_copied + work.surfaces_written + work.particles_written,
              0u);

    std::optional<bus::Subscriber<msg::MeshState>> meshes(std::in_place, client_, bus::topics::mesh_state);
    (void)whole_state(*meshes);
    EXPECT_GT(work.surfaces_written, 0u);
    EXPECT_EQ(work.particles_copied + work.particles_written, 0u);
    meshes.reset();

    bus::Subscriber<msg::ParticleState> particles(client_, bus::topics::particle_state);
    (void)whole_state(particles);
    const auto still = [&] {
        const std::uint64_t before = work.surfaces_written;
        steps(12);
        return work.surfaces_written == before;
    };
    ASSERT_TRUE(eventually(still)) << "surfaces go on without a reader";
    const std::uint64_t copied = work.frames_copied, surfaces = work.surfaces_written,
                        written = work.particles_written;
    steps(60);
    EXPECT_EQ(work.frames_copied, copied);
    EXPECT_EQ(work.surfaces_written, surfaces);
    EXPECT_GT(work.particles_written, written);
}

TEST_F(LabOutputTest, SurfacesMatchClientSkinning) {
    bus::Subscriber<msg::MeshState> reader(client_, bus::topics::mesh_state);
    std::map<std::string, std::size_t> vertices;
    for (const auto& [number, message] : whole_state(reader)) {
        EXPECT_EQ(message.header().number() % 6, 0u);
        const Surface& surface = patient_.surfaces.at(message.object().to_string() == "face" ? 0 : 1);
        EXPECT_EQ(message.object().to_string(), surface.name);
        std::vector<Vec3f> chunk;
        ASSERT_TRUE(bus::decode_positions(message, 1.0f, chunk));
        for (std::size_t i = 0; i < chunk.size(); ++i) {
            const std::size_t v = message.first() + i;
            const Vec3f exact = skin_point(surface.mesh.vertices.at(v), surface.skin.at(v),
                                           patient_.frame_rest_centre, snapshot_.frames);
            // A matrix in place of a quaternion: some roundings of 2^-24 at 0.2 m.
            const Vec3f most = bound(message) + Vec3f::Constant(8 * 0.2f * 0x1p-24f);
            EXPECT_TRUE(((chunk[i] - exact).cwiseAbs().array() <= most.array()).all()) << surface.name << v;
        }
        vertices[surface.name] += chunk.size();
    }
    EXPECT_EQ(vertices["face"], most_vertices);
    EXPECT_EQ(vertices["tongue"], 40u);
}

TEST_F(LabOutputTest, ParticlesAreGroupedByTissue) {
    bus::Subscriber<msg::ParticleState> reader(client_, bus::topics::particle_state);
    std::map<std::uint32_t, std::size_t> found;
    for (const auto& [number, message] : whole_state(reader)) {
        const bool epiglottis = message.tissue() == static_cast<std::uint32_t>(Tissue::epiglottis);
        EXPECT_EQ(message.count(), epiglottis ? 100u : 400u);
        std::vector<Vec3f> chunk;
        ASSERT_TRUE(bus::decode_positions(message, 1.0f, chunk));
        for (std::size_t i = 0; i < chunk.size(); ++i) {
            const std::size_t n = message.first() + i;
            const std::size_t particle = epiglottis ? 5 * n : 5 * (n / 4) + n % 4 + 1;
            const Vec3f& exact = patient_.particles.rest.at(particle);
            EXPECT_TRUE(((chunk[i] - exact).cwiseAbs().array() <= bound(message).array()).all()) << n;
        }
        found[message.tissue()] += chunk.size();
    }
    EXPECT_EQ(found, (std::map<std::uint32_t, std::size_t>{{1, 400}, {2, 100}}));
}

}  // namespace
}  // namespace eti::app
