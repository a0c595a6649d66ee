// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/output/bus_output.hpp"

#include <algorithm>
#include <set>

#include "common/bus/codec/fluid_state.hpp"
#include "common/bus/security/session_keys.hpp"
#include "tests/unit/common/bus/bus_fixture.hpp"

namespace eti::app {
namespace {

using bus::eventually;
using std::chrono_literals::operator""ms;

class BusOutputTest : public ::testing::Test {
  protected:
    BusOutputTest()
        : server_(bus::options("eti-server")),
          client_(bus::options("client")),
          fluid_(client_, bus::topics::fluid),
          live_(client_, bus::topics::live_metrics) {}

    [[nodiscard]] std::unique_ptr<BusOutput> output(bool saliva) {
        Scenario scenario;
        scenario.name = "test";
        scenario.description = "made by a test";
        scenario.text = "name: test";
        scenario.saliva = saliva;
        RuntimeParameters start;
        start.tongue_scale = 1.25f;
        patient::Patient patient;
        patient.weight = 1.1f;
        for (patient::CarriedPoint& landmark : patient.landmarks) {
            landmark.rest.setConstant(0.01f);
        }
        return std::make_unique<BusOutput>(server_, scenario, patient, make_laryngoscope(Blade::miller_0),
                                           start);
    }

    bus::Node server_, client_;
    bus::Subscriber<msg::FluidState> fluid_;
    bus::Subscriber<msg::LiveMetrics> live_;
};

TEST_F(BusOutputTest, DryScenarioHasNoLiquidWriter) {
    const auto writes = output(false);
    // Writers are announced in the order of their creation; the liquid's would come before this one.
    bus::Subscriber<msg::SessionStatus> status(client_, bus::topics::session_status);
    ASSERT_TRUE(eventually([&] { return live_.matched() == 1 && status.matched() == 1; }));
    EXPECT_EQ(fluid_.matched(), 0);
}

TEST_F(BusOutputTest, LateJoinerReceivesSessionDescription) {
    const auto writes = output(false);
    bus::Subscriber<msg::SessionDescription> descriptions(client_, bus::topics::session_description);
    msg::SessionDescription message;
    ASSERT_TRUE(eventually([&] { return descriptions.take(message); }));
    EXPECT_EQ(message.scenario().to_string(), "test");
    EXPECT_EQ(message.description().to_string(), "made by a test");
    EXPECT_EQ(message.scenario_text(), "name: test");
    EXPECT_EQ(message.version().to_string(), ETI_VERSION);
    std::string why;
    const auto keys = bus::SessionKeys::of(message, why);
    ASSERT_TRUE(keys) << why;
    EXPECT_EQ(keys->laryngoscope().blade, Blade::miller_0);
    EXPECT_FLOAT_EQ(static_cast<float>(keys->patient_weight()), 1.1f);
    const auto tongue =
        std::ranges::find_if(message.live(), [](const auto& key) { return key.name() == "tongue_scale"; });
    ASSERT_NE(tongue, message.live().end());
    EXPECT_EQ(tongue->start(), 1.25f);
}

TEST_F(BusOutputTest, LiquidArrivesInEverySecondStep) {
    const auto writes = output(true);
    ASSERT_TRUE(eventually([&] { return fluid_.matched() == 1; }));
    scene::Snapshot snapshot;
    snapshot.saliva.on = true;
    snapshot.saliva.spacing = 0.7e-3f;
    snapshot.saliva.lower = Vec3f::Constant(-0.1f);
    snapshot.saliva.upper = Vec3f::Constant(0.1f);
    snapshot.saliva.positions.assign(bus::fluid_chunk_particles + 1, Vec3f(0.01f, 0.02f, 0.03f));
    std::vector<Vec3f> arrived;
    msg::FluidState message;
    // Best effort: the reader may match later than the writer.
    const bool whole = eventually([&] {
        snapshot.step += 1;
        snapshot.time_ns += 5'000'000;
        writes->post(snapshot, {});
        std::this_thread::sleep_for(10ms);
        while (fluid_.take(message)) {
            EXPECT_EQ(message.header().simulation_time_ns() % 10'000'000, 0u) << "an odd step";
            EXPECT_TRUE(bus::decode_fluid_chunk(message, 1.0f, arrived));
        }
        return arrived.size() >= snapshot.saliva.positions.size();
    });
    ASSERT_TRUE(whole);
    // Half of a 65535th of 0.2 m in each direction.
    EXPECT_LT((arrived.back() - Vec3f(0.01f, 0.02f, 0.03f)).norm(), 1.74f * 0.2f / 131070.0f);
}

TEST_F(BusOutputTest, LiveMetricsCarrySnapshotTime) {
    const auto writes = output(false);
    ASSERT_TRUE(eventually([&] { return live_.matched() == 1; }));
    scene::Snapshot snapshot;
    snapshot.step = 12;
    snapshot.time_ns = 66'666'666;
    snapshot.landmarks[3] = Vec3f(0.1f, 0.2f, 0.3f);
    AttemptStatus values;
    values.measures.glottic_opening_percent = 42.0f;
    msg::LiveMetrics message;
    ASSERT_TRUE(eventually([&] {
        writes->post_live(snapshot, values);
        std::this_thread::sleep_for(10ms);
        return live_.take_latest(message);
    }));
    EXPECT_EQ(message.header().simulation_time_ns(), snapshot.time_ns);
    EXPECT_EQ(message.measures().size(), live_measure_fields.size());
    EXPECT_EQ(message.measures()[1], 42.0f) << live_measure_fields[1].key;
    EXPECT_EQ(message.landmarks()[3].y(), 0.2f);
}

TEST_F(BusOutputTest, ReplacedStateStillPublishesDueStatus) {
    const auto writes = output(false);
    bus::Subscriber<msg::SessionStatus> status(client_, bus::topics::session_status);
    ASSERT_TRUE(eventually([&] { return status.matched() == 1; }));
    scene::Snapshot snapshot;
    msg::SessionStatus message;
    // Never a multiple of the 18 steps after which a status is due.
    for (const std::uint64_t step : {20u, 38u, 56u}) {
        snapshot.step = step;
        writes->post(snapshot, {});
        ASSERT_TRUE(eventually([&] { return status.take(message) && message.header().number() == step; }))
            << step;
    }
}

// A state of many frames, of which each message without a refresh carries a part.
scene::Snapshot still_snapshot() {
    scene::Snapshot snapshot;
    snapshot.step = 24;
    snapshot.time_ns = 133'333'333;
    snapshot.frames.resize(400);
    for (FramePose& frame : snapshot.frames) {
        frame.centre.setConstant(0.02f);
    }
    snapshot.tube_nodes.assign(4, Vec3f(0.01f, 0.02f, 0.03f));
    return snapshot;
}

// Frames of the newest moment that have arrived, and whether its measures have.
class Joiner {
  public:
    Joiner(bus::Node& node, const bus::Topic<msg::DeformationState>& topic)
        : shapes_(node, topic), live_(node, bus::topics::live_metrics) {}

    [[nodiscard]] bool sees(const scene::Snapshot& snapshot) {
        while (shapes_.take(shape_)) {
            if (shape_.header().simulation_time_ns() == snapshot.time_ns) {
                for (const msg::FrameUpdate& frame : shape_.frames()) {
                    frames_.insert(frame.frame());
                }
            }
        }
        while (live_.take(measures_)) {
            measured_ = measured_ || measures_.header().simulation_time_ns() == snapshot.time_ns;
        }
        return measured_ && frames_.size() == snapshot.frames.size();
    }

  private:
    bus::Subscriber<msg::DeformationState> shapes_;
    bus::Subscriber<msg::LiveMetrics> live_;
    msg::DeformationState shape_;
    msg::LiveMetrics measures_;
    std::set<std::uint16_t> frames_;
    bool measured_ = false;
};

TEST_F(BusOutputTest, JoinerSeesStateThatStandsStill) {
    const auto writes = output(false);
    const scene::Snapshot snapshot = still_snapshot();
    StatusValues frozen;
    frozen.phase = msg::PHASE_FROZEN;
    writes->post(snapshot, {});
    writes->post_live(snapshot, {});
    std::this_thread::sleep_for(100ms);  // nothing is left to send
    for (const auto& topic : {bus::topics::deformation, bus::topics::deformation_slow}) {
        Joiner joiner(client_, topic);
        EXPECT_TRUE(eventually([&] {
            writes->post_status(frozen);
            std::this_thread::sleep_for(50ms);
            return joiner.sees(snapshot);
        })) << topic.name;
    }
}

TEST_F(BusOutputTest, PausedReplayShowsEveryMoment) {
    const auto writes = output(false);
    scene::Snapshot snapshot = still_snapshot();
    StatusValues frozen;
    frozen.phase = msg::PHASE_FROZEN;
    for (const auto& topic : {bus::topics::deformation, bus::topics::deformation_slow}) {
        Joiner joiner(client_, topic);
        EXPECT_TRUE(eventually([&] {
            writes->post(snapshot, frozen);
            writes->post_live(snapshot, {});
            std::this_thread::sleep_for(50ms);
            return joiner.sees(snapshot);
        })) << topic.name;
        // A step of two, to a moment at which no shape is due for slow readers.
        snapshot.step += 2;
        snapshot.time_ns += 11'111'111;
        Joiner next(client_, topic);
        EXPECT_TRUE(eventually([&] {
            writes->post(snapshot, frozen);
            writes->post_live(snapshot, {});
            std::this_thread::sleep_for(50ms);
            return next.sees(snapshot);
        })) << topic.name;
    }
}

}  // namespace
}  // namespace eti::app
