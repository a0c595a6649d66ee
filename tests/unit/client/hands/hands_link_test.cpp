// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hands/hands_link.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <thread>

#include "common/bus/codec/convert.hpp"
#include "synthetic_scene.hpp"
#include "tests/support/bus_domain.hpp"

namespace eti {
namespace {

using namespace std::chrono_literals;

bus::Options options(const std::string& name) {
    return test::bus_options(name, "hands-test-" + std::to_string(::getpid()));
}

// A server that only publishes positions and receives the tools' poses.
class HandsLinkTest : public ::testing::Test {
  protected:
    // Advances simulation time until `enough`, or until the timeout.
    bool follow(const std::function<bool()>& enough) {
        const auto limit = std::chrono::steady_clock::now() + 120s;
        while (!enough()) {
            if (std::chrono::steady_clock::now() > limit) {
                return false;
            }
            time_ns_ += 10'000'000;
            proxy_.publish(synthetic::proxy(scene_, time_ns_));
            metrics_.publish(synthetic::metrics(scene_, time_ns_, 0.0f));
            status_.publish(synthetic::status(msg::PHASE_RUNNING));
            status_.assert_liveliness();
            if (blade_.take_latest(heard_)) {
                ++heard_count_;
            }
            std::this_thread::sleep_for(10ms);
        }
        return true;
    }
    void SetUp() override { description_.publish(scene_.description); }

    synthetic::Scene scene_ = synthetic::make_scene();
    bus::Node server_{options("eti-server")};
    bus::Publisher<msg::SessionDescription> description_{server_, bus::topics::session_description};
    bus::Publisher<msg::SessionStatus> status_{server_, bus::topics::session_status};
    bus::Publisher<msg::ProxyState> proxy_{server_, bus::topics::proxy};
    bus::Publisher<msg::LiveMetrics> metrics_{server_, bus::topics::live_metrics};
    bus::Subscriber<msg::ToolPose> blade_{server_, bus::topics::laryngoscope_pose};
    msg::ToolPose heard_;
    int heard_count_ = 0;
    std::uint64_t time_ns_ = 0;
    bus::Node client_{options("eti-client")};
};

TEST_F(HandsLinkTest, PublishesHandPosesLikeDevice) {
    hands::HandsLink link(client_, std::nullopt);
    ASSERT_TRUE(follow([&] { return heard_count_ > 20; }));
    const Vec3f before = bus::from_msg(heard_.pose().position());
    link.press(U'w');
    ASSERT_TRUE(follow([&] { return (bus::from_msg(heard_.pose().position()) - before).norm() > 5e-3f; }));
    link.release(U'w');
    EXPECT_TRUE(bus::valid_pose(heard_.pose()));
    const hands::HandsState state = link.state();
    EXPECT_TRUE(state.holding && state.owned[0] && state.owned[1]);
}

TEST_F(HandsLinkTest, DoesNotPublishToolHeldByDevice) {
    bus::Node tracker(options("eti-haptics"));
    bus::Publisher<msg::ToolPose> device(tracker, bus::topics::laryngoscope_pose);
    hands::HandsLink link(client_, std::nullopt);
    ASSERT_TRUE(follow([&] { return link.state().holding && !link.state().owned[0]; }));
    EXPECT_EQ(link.state().poses[0], 0u) << "not one pose beside the device's";
    ASSERT_TRUE(follow([&] { return link.state().poses[1] > 20; })) << "the tube is still the hand's";
}

TEST_F(HandsLinkTest, ReleasesToolWhenDeviceAppears) {
    hands::HandsLink link(client_, std::nullopt);
    ASSERT_TRUE(follow([&] { return heard_count_ > 5; }));
    bus::Node tracker(options("eti-haptics"));
    const bus::Publisher<msg::ToolPose> device(tracker, bus::topics::laryngoscope_pose);
    ASSERT_TRUE(follow([&] { return !link.state().owned[0]; }));
    const std::uint32_t written = link.state().poses[0];
    const std::uint64_t until = time_ns_ + 500'000'000;
    ASSERT_TRUE(follow([&] { return time_ns_ > until; }));
    EXPECT_EQ(link.state().poses[0], written);
    EXPECT_TRUE(link.state().owned[1]);
}

}  // namespace
}  // namespace eti
