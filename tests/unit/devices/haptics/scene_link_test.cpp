// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/scene_link.hpp"

#include <limits>

#include "bus_fixture.hpp"
#include "devices/haptics/timing.hpp"
#include "tests/support/session_description.hpp"

namespace eti::devices {
namespace {

constexpr std::uint64_t step_ns = 1'000'000'000 / 180;

/// Publishes a server's messages, one at a time.
struct Server {
    bus::Node node{options("eti-server")};
    bus::Publisher<msg::ProxyState> proxy{node, bus::topics::proxy};
    bus::Publisher<msg::TissueContacts> tissue{node, bus::topics::tissue_contacts};
    bus::Publisher<msg::LiveMetrics> live{node, bus::topics::live_metrics};
    bus::Publisher<msg::SessionDescription> description{node, bus::topics::session_description};
    bus::Publisher<msg::SessionStatus> status{node, bus::topics::session_status};

    void show_tools() {
        Tube tube;
        tube.grip_from_tip = 0.09f;
        msg::SessionDescription message =
            test::session_description(zero_landmarks(), make_laryngoscope(Blade::miller_0), tube);
        message.patient_weight_kg(1.1f);
        ASSERT_TRUE(description.publish(message));
    }

    static msg::LiveMetrics metrics() {
        msg::LiveMetrics out;
        out.header(bus::make_header(7 * step_ns, 1));
        bus::set_measures({.glottic_opening_percent = 44.0f, .tube_depth_past_glottis = -0.02f}, out);
        out.tube_tip(bus::to_msg(Vec3f(0.1f, 0.2f, 0.3f)));
        for (std::size_t i = 0; i < landmark_count; ++i) {
            out.landmarks().push_back(bus::to_msg(Vec3f(0.125f * static_cast<float>(i), 0, 0)));
        }
        return out;
    }

    static msg::ProxyState state(std::uint64_t step) {
        msg::ProxyState out;
        out.header(bus::make_header(step * step_ns, static_cast<std::uint32_t>(step)));
        out.device(bus::to_msg(RigidTransform{}));
        out.proxy(bus::to_msg(RigidTransform{Quatf::Identity(), {0, 0.001f * static_cast<float>(step), 0}}));
        return out;
    }
};

class SceneLinkTest : public ::testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(eventually([&] {
            return server_.proxy.matched() == 1 && server_.tissue.matched() == 1 &&
                   server_.live.matched() == 1;
        }));
    }

    const SceneState& newest() {
        const SceneState* state = nullptr;
        (void)link_.newest().read(state);
        return *state;
    }

    Server server_;
    bus::Node node_{options("device")};
    SceneLink link_{node_, SceneLink::ForceSource::tissue};
};

TEST_F(SceneLinkTest, CollectsTheScriptsSurroundings) {
    EXPECT_FALSE(link_.initial_scene());
    server_.show_tools();
    EXPECT_FALSE(link_.initial_scene()) << "no landmarks yet";
    ASSERT_TRUE(eventually([&] {
        server_.live.publish(Server::metrics());
        return link_.initial_scene().has_value();
    }));
    const InitialScene around = *link_.initial_scene();
    EXPECT_FLOAT_EQ(around.blade_length, 0.076f);
    EXPECT_FLOAT_EQ(around.grip_to_tip, 0.09f);
    EXPECT_FLOAT_EQ(around.tube_curvature, 1.0f / 0.14f);
    EXPECT_FLOAT_EQ(around.seen.tube_depth_rule, 0.071f);
    EXPECT_FLOAT_EQ(around.seen.glottic_opening_percent, 44.0f);
    EXPECT_FLOAT_EQ(around.seen.tube_depth_past_glottis, -0.02f);
    EXPECT_EQ(around.seen.tube_tip, Vec3f(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(at(around.seen.landmarks, Landmark::carina), Vec3f(14 * 0.125f, 0, 0));
    EXPECT_NEAR(around.seen.time, 7.0 / 180.0, 1e-6);
    ASSERT_TRUE(eventually([&] {
        server_.proxy.publish(Server::state(8));
        return newest().blade[2].b.z() > 0.0f;
    }));
    EXPECT_FLOAT_EQ(newest().blade[2].b.z(), make_laryngoscope(Blade::miller_0).capsules[2].b.z());
}

TEST_F(SceneLinkTest, ReceivesProxyAndTissue) {
    msg::ProxyState state = Server::state(5);
    state.contacts().emplace_back();
    state.contacts().back().normal(bus::to_msg(Vec3f(0, 0, 1)));
    msg::TissueContacts tissue;
    tissue.proxy(bus::to_msg(RigidTransform{}));
    tissue.force(bus::to_msg(Vec3f(1, 2, 3)));
    tissue.contacts().emplace_back();
    tissue.contacts().back().tissue(static_cast<std::uint32_t>(Tissue::epiglottis));
    tissue.contacts().back().radius(0.5e-3f);
    const std::int64_t before = monotonic_ns();
    ASSERT_TRUE(eventually([&] {
        server_.proxy.publish(state);
        server_.tissue.publish(tissue);
        return newest().proxy_arrived > 0 && newest().tissue_arrived > 0;
    }));
    const SceneState& got = newest();
    EXPECT_EQ(got.proxy.proxy.pose.translation, bus::from_msg(state.proxy()).translation);
    ASSERT_EQ(got.proxy.contacts, 1u);
    EXPECT_EQ(got.proxy.normals[0], Vec3f(0, 0, 1));
    EXPECT_EQ(got.tissue.wrench.force, Vec3f(1, 2, 3));
    ASSERT_EQ(got.tissue.count, 1u);
    EXPECT_EQ(got.tissue.points[0].tissue, Tissue::epiglottis);
    EXPECT_NEAR(got.seen.time, 5.0 / 180.0, 1e-6);
    EXPECT_GT(got.proxy_arrived, before);
    EXPECT_LE(got.proxy_arrived, monotonic_ns());

    // An implausible one cancels the previous force, at once and not when that is stale.
    msg::ProxyState bad = state;
    bad.velocity().x(std::numeric_limits<float>::quiet_NaN());
    EXPECT_TRUE(eventually([&] {
        server_.proxy.publish(bad);
        return newest().proxy_arrived == 0;
    }));
    msg::TissueContacts worse = tissue;
    worse.force(bus::to_msg(Vec3f(0, std::numeric_limits<float>::infinity(), 0)));
    EXPECT_TRUE(eventually([&] {
        server_.tissue.publish(worse);
        return newest().tissue_arrived == 0;
    }));
    EXPECT_TRUE(eventually([&] {
        server_.proxy.publish(state);
        server_.tissue.publish(tissue);
        return newest().proxy_arrived > 0 && newest().tissue_arrived > 0;
    }));
}

TEST_F(SceneLinkTest, NonFiniteOrIncompatibleMessageIsRefused) {
    const float bad = std::numeric_limits<float>::quiet_NaN();
    msg::ProxyState pose = Server::state(1);
    pose.proxy().position().x(bad);
    msg::ProxyState turn = Server::state(1);
    turn.device().orientation().w(0.0f);
    msg::ProxyState speed = Server::state(1);
    speed.velocity().y(std::numeric_limits<float>::infinity());
    msg::ProxyState never = Server::state(1);
    never.header().simulation_time_ns(~std::uint64_t{0});
    msg::ProxyState normal = Server::state(1);
    normal.contacts().emplace_back();
    std::uint64_t refused = 0;
    for (const msg::ProxyState& message : {pose, turn, speed, never, normal}) {
        ASSERT_TRUE(eventually([&] {
            server_.proxy.publish(message);
            return link_.refused() > refused;
        }));
        refused = link_.refused();
    }
    msg::TissueContacts place;
    msg::TissueContacts force;
    force.proxy(bus::to_msg(RigidTransform{}));
    force.force(bus::to_msg(Vec3f(bad, 0, 0)));
    msg::TissueContacts tissue;
    tissue.proxy(bus::to_msg(RigidTransform{}));
    tissue.contacts().emplace_back();
    tissue.contacts().back().tissue(tissue_count);
    for (const msg::TissueContacts& message : {place, force, tissue}) {
        ASSERT_TRUE(eventually([&] {
            server_.tissue.publish(message);
            return link_.refused() > refused;
        }));
        refused = link_.refused();
    }
    server_.show_tools();
    msg::LiveMetrics fewer = Server::metrics();
    fewer.landmarks().pop_back();
    ASSERT_TRUE(eventually([&] {
        server_.live.publish(fewer);
        return link_.refused() > refused;
    }));
    EXPECT_EQ(newest().proxy_arrived, 0);
    EXPECT_EQ(newest().tissue_arrived, 0);
    EXPECT_EQ(link_.received(), 0u);
}

TEST_F(SceneLinkTest, MeasuresPaceAndDetectsNewSession) {
    // Half a second at 2 ms a step is 2.8 times faster than real time; sleeping is inexact, so the rate is
    // compared with what was really sent.
    const std::int64_t start = monotonic_ns();
    std::uint64_t step = 1000;
    while (monotonic_ns() - start < 800'000'000) {
        server_.proxy.publish(Server::state(++step));
        std::this_thread::sleep_for(2ms);
    }
    const double pace =
        static_cast<double>(step - 1000) / 180.0 / (static_cast<double>(monotonic_ns() - start) * 1e-9);
    ASSERT_TRUE(eventually([&] { return newest().seen.time > 5.0; }));
    EXPECT_NEAR(newest().pace, pace, 0.2 * pace);
    const std::uint32_t session = newest().session;
    ASSERT_TRUE(eventually([&] {
        server_.proxy.publish(Server::state(1));
        return newest().seen.time < 1.0;
    }));
    EXPECT_EQ(newest().session, session + 1);
}

TEST_F(SceneLinkTest, DetectsTheEndOfTheSession) {
    msg::SessionStatus status;
    status.session("test");
    status.phase(msg::PHASE_RUNNING);
    ASSERT_TRUE(server_.status.publish(status));
    std::this_thread::sleep_for(100ms);
    EXPECT_FALSE(link_.finished());
    status.phase(msg::PHASE_FINISHED);
    ASSERT_TRUE(server_.status.publish(status));
    EXPECT_TRUE(eventually([&] { return link_.finished(); }));
}

// The tube's force has a topic of its own, for a link that subscribes to it.
TEST(TubeLink, AcceptsTubeForceAndRefusesInvalid) {
    Server server;
    bus::Publisher<msg::TubeForce> topic(server.node, bus::topics::tube_force);
    bus::Node node(options("device"));
    SceneLink link(node, SceneLink::ForceSource::tube);
    const SceneState* state = nullptr;
    msg::TubeForce force;
    force.force(bus::to_msg(Vec3f(std::numeric_limits<float>::quiet_NaN(), 0, 0)));
    ASSERT_TRUE(eventually([&] {
        topic.publish(force);
        return link.refused() > 0;
    }));
    force.force(bus::to_msg(Vec3f(0, 0, -0.7f)));
    force.torque(bus::to_msg(Vec3f(0.01f, 0, 0)));
    EXPECT_TRUE(eventually([&] {
        topic.publish(force);
        (void)link.newest().read(state);
        return state->tissue_arrived > 0 && state->tissue.wrench.force == Vec3f(0, 0, -0.7f);
    }));
    EXPECT_EQ(state->tissue.wrench.torque, Vec3f(0.01f, 0, 0));
}

}  // namespace
}  // namespace eti::devices
