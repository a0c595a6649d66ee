// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "bus_fixture.hpp"
#include "messages.hpp"

namespace eti::bus {
namespace {

/// Sends an example between two nodes and expects it back member by member.
template <class Message>
void expect_round_trip(const Topic<Message>& topic) {
    SCOPED_TRACE(topic.name);
    Node sender(options("eti-server"));
    Node receiver(options("receiver"));
    Publisher<Message> publisher(sender, topic);
    Subscriber<Message> subscriber(receiver, topic);
    ASSERT_TRUE(eventually([&] { return publisher.matched() >= 1 && subscriber.matched() >= 1; }));
    const Message sent = example<Message>();
    Message received;
    ASSERT_FALSE(sent == received) << "an example equal to an empty message proves nothing";
    // A reader may match later on its own side and miss a best-effort sample: send again.
    bool arrived = false;
    for (int attempt = 0; attempt < 50 && !arrived; ++attempt) {
        ASSERT_TRUE(publisher.publish(sent));
        arrived = subscriber.wait(100ms) && subscriber.take(received);
    }
    ASSERT_TRUE(arrived);
    EXPECT_TRUE(sent == received);
}

TEST(RoundTrip, EveryTopic) {
#define ETI_TRIP(name, ...) expect_round_trip(topics::name);
    ETI_TOPICS(ETI_TRIP)
#undef ETI_TRIP
}

// A scene object larger than any datagram arrives complete.
TEST(RoundTrip, TwoMegabytes) {
    Node sender(options("eti-server"));
    Node receiver(options("receiver"));
    Publisher<msg::SceneDescription> publisher(sender, topics::scene);
    Subscriber<msg::SceneDescription> subscriber(receiver, topics::scene);
    ASSERT_TRUE(eventually([&] { return publisher.matched() == 1 && subscriber.matched() == 1; }));
    msg::SceneDescription sent = example<msg::SceneDescription>();
    sent.vertices().resize(500'000);
    for (std::size_t i = 0; i < sent.vertices().size(); ++i) {
        sent.vertices()[i] = static_cast<float>(i);
    }
    ASSERT_TRUE(publisher.publish(sent));
    msg::SceneDescription received;
    ASSERT_TRUE(eventually([&] { return subscriber.take(received); }));
    EXPECT_TRUE(sent == received);
}

TEST(RoundTrip, BothToolsShareOneType) {
    Node node(options("eti-server"));
    Publisher<msg::ToolPose> scope(node, topics::laryngoscope_pose);
    Publisher<msg::ToolPose> tube(node, topics::tube_pose);
    Subscriber<msg::ToolPose> scope_reader(node, topics::laryngoscope_pose);
    Subscriber<msg::ToolPose> tube_reader(node, topics::tube_pose);
    ASSERT_TRUE(eventually([&] { return scope.matched() == 1 && tube.matched() == 1; }));
    msg::ToolPose pose = example<msg::ToolPose>();
    ASSERT_TRUE(eventually([&] { return tube.publish(pose) && tube_reader.take(pose); }));
    EXPECT_FALSE(scope_reader.take(pose)) << "the laryngoscope's topic heard the tube";
}

TEST(RoundTrip, EndpointsMayOutliveTheirNode) {
    auto node = std::make_unique<Node>(options("short"));
    Publisher<msg::ToolPose> publisher(*node, topics::tube_pose);
    Subscriber<msg::ToolPose> subscriber(*node, topics::tube_pose);
    node.reset();
    ASSERT_TRUE(eventually([&] { return publisher.matched() == 1; }));
    msg::ToolPose received;
    EXPECT_TRUE(
        eventually([&] { return publisher.publish(example<msg::ToolPose>()) && subscriber.take(received); }));
}

TEST(RoundTrip, SampleExceedingItsBoundIsNotSent) {
    Node node(options("eti-server"));
    Publisher<msg::ProxyState> proxy(node, topics::proxy);
    msg::ProxyState message = example<msg::ProxyState>();
    EXPECT_TRUE(proxy.publish(message));
    message.contacts().emplace_back();
    EXPECT_FALSE(proxy.publish(message)) << "17 contacts where eti.idl allows 16";
}

}  // namespace
}  // namespace eti::bus
