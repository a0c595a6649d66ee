// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/haptic_loop.hpp"

#include <algorithm>
#include <cmath>

#include "bus_fixture.hpp"
#include "devices/haptics/scene_link.hpp"
#include "devices/sensor/hand_sensor.hpp"

namespace eti::devices {
namespace {

/// The server's side of the bus: answers the device's newest pose at 180 Hz with a proxy displaced by `push`
/// along a floor's normal, and a force of the tissue.
class Answering {
  public:
    Answering() : thread_([this] { run(); }) {}
    ~Answering() { stop(); }
    void stop() {
        ending_ = true;
        if (thread_.joinable()) {
            thread_.join();
        }
    }
    std::atomic<float> push{0.0f};    // [m]
    std::atomic<float> tissue{0.0f};  // [N]
    /// [m], height below which the device presses on tissue: particles on springs of 160 N/m in total.
    std::atomic<float> surface{-1.0f};
    std::atomic<std::uint64_t> heard{0};

  private:
    void run() {
        msg::ToolPose tool;
        msg::ProxyState state;
        msg::TissueContacts contacts;
        bool present = false;
        for (std::uint64_t step = 0; !ending_; ++step) {
            while (tools_.take(tool)) {
                present = true;
                ++heard;
            }
            if (present) {
                state.header(bus::make_header(step * 1'000'000'000 / 180, static_cast<std::uint32_t>(step)));
                state.device(tool.pose());
                RigidTransform proxy = bus::from_msg(tool.pose());
                proxy.translation.y() += push;
                state.proxy(bus::to_msg(proxy));
                state.contacts().clear();
                if (push > 0.0f) {
                    state.contacts().emplace_back();
                    state.contacts().back().normal(bus::to_msg(Vec3f(Vec3f::UnitY())));
                }
                proxies_.publish(state);
                contacts.header(state.header());
                contacts.proxy(state.proxy());
                contacts.force(bus::to_msg(Vec3f(0.0f, tissue, 0.0f)));
                press(proxy, contacts);
                tissues_.publish(contacts);
            }
            std::this_thread::sleep_for(std::chrono::microseconds(5556));
        }
    }

    void press(const RigidTransform& blade, msg::TissueContacts& contacts) const {
        constexpr int particles = 20;
        const float depth = surface - blade.translation.y();
        contacts.contacts().clear();
        if (depth <= 0.0f) {
            return;
        }
        const float force = 160.0f * depth / static_cast<float>(particles);
        Vec3f torque = Vec3f::Zero();
        for (int i = 0; i < particles; ++i) {
            const Vec3f arm(0.0f, 0.0f, 2e-3f * static_cast<float>(i));
            const Vec3f position = blade.translation + arm;
            msg::TissueContactPoint& point = contacts.contacts().emplace_back();
            point.position(bus::to_msg(position));
            point.rest(bus::to_msg(Vec3f(position + Vec3f(0.0f, depth, 0.0f))));
            point.radius(1e-3f);
            point.tissue(static_cast<std::uint8_t>(Tissue::tongue));
            point.force(bus::to_msg(Vec3f(0.0f, force, 0.0f)));
            torque += arm.cross(Vec3f(0.0f, force, 0.0f));
        }
        contacts.force(bus::to_msg(Vec3f(0.0f, static_cast<float>(particles) * force, 0.0f)));
        contacts.torque(bus::to_msg(torque));
    }

    bus::Node node_{options("eti-server")};
    bus::Subscriber<msg::ToolPose> tools_{node_, bus::topics::laryngoscope_pose};
    bus::Publisher<msg::ProxyState> proxies_{node_, bus::topics::proxy};
    bus::Publisher<msg::TissueContacts> tissues_{node_, bus::topics::tissue_contacts};
    std::atomic<bool> ending_{false};
    std::thread thread_;
};

struct Device {
    bus::Node node{options("device")};
    SceneLink link{node, SceneLink::ForceSource::tissue};
    HandSensor sensor{SensorSetup{}};
    HapticLoop loop;
    Device() : loop(node, sensor, link.newest(), {}) {}
};

TEST(HapticLoop, ForceEndsWithin300msOfServerStop) {
    // A busy machine may answer too late, and then the force fades in and out; the test is about the end, so
    // the start gets more time.
    auto server = std::make_unique<Answering>();
    Device device;
    ASSERT_TRUE(eventually([&] { return server->heard > 200; }));
    std::this_thread::sleep_for(200ms);
    server->push = 2e-3f;
    server->tissue = 1.0f;
    ASSERT_TRUE(eventually([&] { return device.loop.force() > 1.5f; })) << device.loop.force();
    server->stop();
    ASSERT_TRUE(eventually([&] { return device.loop.force() == 0.0f; }));
    std::this_thread::sleep_for(100ms);
    EXPECT_EQ(device.loop.force(), 0.0f);
    device.loop.stop();
    const HapticRecord& record = device.loop.cycle().record();
    ASSERT_GT(record.last_force, record.last_message);
    // A late cycle adds its lateness.
    const double lateness = record.intervals.longest() - 1e-3;
    EXPECT_LT(static_cast<double>(record.last_force - record.last_message) * 1e-9, 0.300 + lateness);
    EXPECT_GT(static_cast<double>(record.last_force - record.last_message) * 1e-9, 0.290 - lateness);
}

TEST(HapticLoop, ForceRecoversWithTheServer) {
    Device device;
    auto server = std::make_unique<Answering>();
    ASSERT_TRUE(eventually([&] { return server->heard > 200; }));
    std::this_thread::sleep_for(200ms);
    server->tissue = 2.0f;
    ASSERT_TRUE(eventually([&] { return device.loop.force() > 1.8f; }));
    server.reset();
    ASSERT_TRUE(eventually([&] { return device.loop.force() == 0.0f; }));
    server = std::make_unique<Answering>();
    server->tissue = 2.0f;
    EXPECT_TRUE(eventually([&] { return device.loop.force() > 1.8f; }));
}

/// A device moved kinematically to the test's target, at 20 mm/s.
class Carried final : public Sensor {
  public:
    Reading exchange(const Wrench& wrench, float elapsed) override {
        const float reach = 0.02f * std::min(elapsed, 2e-3f);
        const float way = std::clamp(wanted - at_, -reach, reach);
        at_ += way;
        force = wrench.force.y();
        torque = wrench.torque.x();
        Reading reading;
        reading.motion.pose.translation = {0.0f, at_, 0.0f};
        reading.motion.velocity = {0.0f, elapsed > 0.0f ? way / elapsed : 0.0f, 0.0f};
        reading.sample = ++sample_;
        return reading;
    }
    std::atomic<float> wanted{0.0f}, force{0.0f}, torque{0.0f};  // [m], [N], [N m]

  private:
    float at_ = 0.0f;
    std::uint64_t sample_ = 0;
};

// Pressed into spring-borne tissue across DDS: the hand feels the springs where it presses them, and no
// longer after release.
TEST(HapticLoop, TissueForceArrivesOverTheBus) {
    Answering server;
    bus::Node node(options("pressing"));
    SceneLink link(node, SceneLink::ForceSource::tissue);
    Carried device;
    HapticLoop loop(node, device, link.newest(), {});
    server.surface = -1e-3f;
    ASSERT_TRUE(eventually([&] { return server.heard > 200; }));
    std::this_thread::sleep_for(800ms);  // quiet cycles, and the ramp
    EXPECT_EQ(device.force, 0.0f);
    device.wanted = -6e-3f;
    // 5 mm deep at 160 N/m, to half a particle's share.
    ASSERT_TRUE(eventually([&] { return std::abs(device.force - 0.8f) < 0.02f; })) << device.force;
    // The particles' centroid is 19 mm along the blade: r x F = -z F about x.
    EXPECT_TRUE(eventually([&] { return std::abs(device.torque + 0.019f * 0.8f) < 0.019f * 0.02f; }))
        << device.torque;
    device.wanted = 0.0f;
    EXPECT_TRUE(eventually([&] { return device.force == 0.0f; })) << device.force;
    loop.stop();
}

TEST(HapticLoop, PublishesPosesAtItsRate) {
    bus::Node listener(options("listener"));
    bus::Subscriber<msg::ToolPose> poses(listener, bus::topics::laryngoscope_pose);
    Device device;
    ASSERT_TRUE(eventually([&] { return poses.matched() == 1; }));
    const auto begin = std::chrono::steady_clock::now();
    msg::ToolPose pose;
    std::uint32_t first = 0, last = 0;
    while (last - first < 300 && std::chrono::steady_clock::now() < begin + test::default_timeout) {
        (void)poses.wait(20ms);
        while (poses.take(pose)) {
            first = first == 0 ? pose.header().number() : first;
            EXPECT_GE(pose.header().number(), last);
            last = pose.header().number();
        }
    }
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    device.loop.stop();
    EXPECT_TRUE(bus::valid_pose(pose.pose()));
    EXPECT_LT((bus::from_msg(pose.pose()).translation - parked_pose(Tool::laryngoscope).translation).norm(),
              1e-4f);
    // At most one a millisecond, and the late ones from just before.
    EXPECT_LE(last - first, took.count() + 100.0);
    EXPECT_GE(last - first, 300u);
    EXPECT_LE(device.loop.published(), device.loop.cycle().record().intervals.count() + 1);
}

}  // namespace
}  // namespace eti::devices
