// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/output/haptic_publisher.hpp"

#include "common/bus/codec/convert.hpp"
#include "tests/unit/common/bus/bus_fixture.hpp"

namespace eti::app {
namespace {

using bus::eventually;

class HapticPublisherTest : public ::testing::Test {
  protected:
    HapticPublisherTest()
        : server_(bus::options("eti-server")),
          hand_(bus::options("hand")),
          proxies_(hand_, bus::topics::proxy),
          contacts_(hand_, bus::topics::tissue_contacts),
          tube_(hand_, bus::topics::tube_force),
          output_(server_) {
        snapshot_.proxy.translation = Vec3f(0.1f, 0.2f, 0.3f);
        snapshot_.shell_contacts.resize(20);
        snapshot_.tissue_contacts.resize(100);
        snapshot_.tissue_force = Vec3f(1.0f, 2.0f, 3.0f);
        snapshot_.tube_force = Vec3f(4.0f, 5.0f, 6.0f);
    }

    /// Whether the proxy of a new step arrives. Best effort: the reader may match later than the writer, and
    /// earlier samples are lost.
    bool proxy_arrives() {
        return eventually([&] {
            ++snapshot_.step;
            output_.post_proxy(snapshot_);
            return proxies_.wait(std::chrono::milliseconds(20)) && proxies_.take_latest(proxy_);
        });
    }

    bus::Node server_, hand_;
    bus::Subscriber<msg::ProxyState> proxies_;
    bus::Subscriber<msg::TissueContacts> contacts_;
    bus::Subscriber<msg::TubeForce> tube_;
    HapticPublisher output_;
    scene::Snapshot snapshot_;
    msg::ProxyState proxy_;
    msg::TissueContacts tissue_;
    msg::TubeForce force_;
};

TEST_F(HapticPublisherTest, ProxyIsSentBeforeTissueForces) {
    ASSERT_TRUE(eventually([&] { return contacts_.matched() == 1 && tube_.matched() == 1; }));
    ASSERT_TRUE(proxy_arrives());
    EXPECT_EQ(bus::from_msg(proxy_.proxy()).translation, snapshot_.proxy.translation);
    EXPECT_EQ(proxy_.contacts().size(), 16u) << "as idl/eti.idl bounds them";
    EXPECT_FALSE(contacts_.take_latest(tissue_)) << "nobody has computed it yet";
    EXPECT_FALSE(tube_.take_latest(force_));
}

TEST_F(HapticPublisherTest, ForcesCarryProxySequenceNumber) {
    ASSERT_TRUE(proxy_arrives());
    snapshot_.step = proxy_.header().number();
    ASSERT_TRUE(eventually([&] {
        output_.post_forces(snapshot_);
        return tube_.wait(std::chrono::milliseconds(20)) && contacts_.take_latest(tissue_) &&
               tube_.take_latest(force_);
    }));
    EXPECT_EQ(tissue_.header().number(), proxy_.header().number());
    EXPECT_EQ(force_.header().number(), proxy_.header().number());
    EXPECT_EQ(bus::from_msg(tissue_.force()), snapshot_.tissue_force);
    EXPECT_EQ(bus::from_msg(force_.force()), snapshot_.tube_force);
    EXPECT_EQ(tissue_.contacts().size(), 96u);
    EXPECT_EQ(tissue_.dropped(), 4u);
}

TEST_F(HapticPublisherTest, FinishSendsPendingProxy) {
    ASSERT_TRUE(proxy_arrives());
    snapshot_.step += 1000;
    output_.post_proxy(snapshot_);
    output_.finish();
    EXPECT_TRUE(eventually([&] { return proxies_.take_latest(proxy_) && proxy_.header().number() > 1000; }));
}

}  // namespace
}  // namespace eti::app
