// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <set>

#include "bus_fixture.hpp"
#include "messages.hpp"

namespace eti::bus {
namespace {

// More objects than the DDS library's default limit of 10 keys; a real scene has about 15.
TEST(Qos, LateJoinerGetsTheLastOfEveryKey) {
    constexpr int objects = 30;
    Node server(options("eti-server"));
    Publisher<msg::SceneDescription> publisher(server, topics::scene);
    for (const std::uint32_t revision : {1u, 2u}) {
        for (int i = 0; i < objects; ++i) {
            auto object = example<msg::SceneDescription>();
            object.object(("object" + std::to_string(i)).c_str());
            object.tissue(revision);
            ASSERT_TRUE(publisher.publish(object));
        }
    }
    Node client(options("client"));
    Subscriber<msg::SceneDescription> subscriber(client, topics::scene);
    std::set<std::string> seen;
    msg::SceneDescription received;
    int samples = 0;
    ASSERT_TRUE(eventually([&] {
        while (subscriber.take(received)) {
            ++samples;
            seen.insert(std::string(received.object().c_str()));
            EXPECT_EQ(received.tissue(), 2u) << "an outdated revision of " << received.object().c_str();
        }
        return seen.size() == objects;
    })) << "only "
        << seen.size();
    EXPECT_EQ(samples, objects);
}

TEST(Qos, ReceivedSampleOutlivesItsWriter) {
    Node client(options("client"));
    Subscriber<msg::SessionStatus> subscriber(client, topics::session_status);
    {
        Node server(options("eti-server"));
        Publisher<msg::SessionStatus> publisher(server, topics::session_status);
        EXPECT_TRUE(publisher.wait_until_received(0ms)) << "nobody has to receive anything";
        ASSERT_TRUE(eventually([&] { return publisher.matched() == 1; }));
        auto status = example<msg::SessionStatus>();
        status.phase(msg::PHASE_FINISHED);
        ASSERT_TRUE(publisher.publish(status));
        EXPECT_TRUE(publisher.wait_until_received(2s));
    }
    // The reader was busy elsewhere when the writer left.
    msg::SessionStatus received;
    ASSERT_TRUE(subscriber.take(received));
    EXPECT_EQ(received.phase(), msg::PHASE_FINISHED);
}

/// That many readers with shared delivery; `network`: over every interface.
void expect_states_reach(int count, bool network) {
    Options of_server = options("eti-server");
    of_server.network = network;
    Node server(of_server);
    Options wanted = options("eti-client");
    wanted.shared_multicast = true;
    wanted.network = network;
    std::vector<std::unique_ptr<Node>> nodes;
    std::vector<Subscriber<msg::DeformationState>> readers;
    for (int i = 0; i < count; ++i) {
        nodes.push_back(std::make_unique<Node>(wanted));
        readers.emplace_back(*nodes.back(), topics::deformation_slow);
    }
    Publisher<msg::DeformationState> states(server, topics::deformation_slow);
    ASSERT_TRUE(eventually([&] {
        return states.matched() == count &&
               std::ranges::all_of(readers, [](const auto& reader) { return reader.matched() == 1; });
    }));
    std::vector<int> got(readers.size(), 0);
    for (int i = 0; i < 50; ++i) {
        ASSERT_TRUE(states.publish(example<msg::DeformationState>()));
        std::this_thread::sleep_for(5ms);
        for (std::size_t r = 0; r < readers.size(); ++r) {
            for (msg::DeformationState message; readers[r].take(message);) {
                ++got[r];
            }
        }
    }
    for (const int states_got : got) {
        EXPECT_GE(states_got, 48);
        EXPECT_LE(states_got, 50) << "no state comes twice";
    }
}

TEST(Qos, MulticastReadersAllGetEveryState) {
    expect_states_reach(4, false);
}

TEST(Qos, SingleMulticastReaderGetsEveryState) {
    expect_states_reach(1, false);
}

TEST(Qos, MulticastReadersOnNetworkGetEveryState) {
    expect_states_reach(1, true);
    expect_states_reach(3, true);
}

TEST(Qos, SessionsAreIsolated) {
    Node a(options("eti-server", "first"));
    Node b(options("b", "second"));
    Node c(options("c", "first"));
    Publisher<msg::LiveMetrics> publisher(a, topics::live_metrics);
    Subscriber<msg::LiveMetrics> other(b, topics::live_metrics);
    Subscriber<msg::LiveMetrics> same(c, topics::live_metrics);
    msg::LiveMetrics received;
    ASSERT_TRUE(
        eventually([&] { return publisher.publish(example<msg::LiveMetrics>()) && same.take(received); }));
    std::this_thread::sleep_for(300ms);
    EXPECT_EQ(other.matched(), 0);
    EXPECT_EQ(publisher.matched(), 1);
    EXPECT_FALSE(other.take(received));
}

/// A connected writer and reader of commands (reliable, keep last 64).
struct CommandPair {
    Node sender{options("eti-server")};
    Node receiver{options("receiver")};
    Publisher<msg::Command> publisher{sender, topics::command};
    Subscriber<msg::Command> subscriber{receiver, topics::command};

    void connect() {
        ASSERT_TRUE(eventually([&] { return publisher.matched() == 1 && subscriber.matched() == 1; }));
    }
    void send(int count) {
        auto command = example<msg::Command>();
        for (int i = 1; i <= count; ++i) {
            command.id(static_cast<std::uint32_t>(i));
            ASSERT_TRUE(publisher.publish(command));
        }
    }
};

TEST(Qos, TakeGivesEveryReliableSampleInOrder) {
    CommandPair pair;
    pair.connect();
    pair.send(60);
    msg::Command received;
    for (std::uint32_t id = 1; id <= 60; ++id) {
        ASSERT_TRUE(eventually([&] { return pair.subscriber.take(received); })) << "command " << id;
        EXPECT_EQ(received.id(), id);
    }
    EXPECT_FALSE(pair.subscriber.take(received));
}

TEST(Qos, TakeLatestReturnsNewestAndEmptiesQueue) {
    CommandPair pair;
    pair.connect();
    pair.send(20);
    std::uint32_t newest = 0;
    int calls = 0;
    msg::Command received;
    ASSERT_TRUE(eventually([&] {
        if (pair.subscriber.take_latest(received)) {
            ++calls;
            EXPECT_GT(received.id(), newest);
            newest = received.id();
        }
        return newest == 20;
    }));
    EXPECT_LT(calls, 20) << "it never skipped one";
    EXPECT_FALSE(pair.subscriber.take_latest(received));
    EXPECT_EQ(received.id(), 20u) << "a call without a sample changed the message";
}

TEST(Qos, WaitReturnsOnArrivalAndOnTimeout) {
    CommandPair pair;
    pair.connect();
    const auto start = Clock::now();
    EXPECT_FALSE(pair.subscriber.wait(50ms));
    EXPECT_GE(Clock::now() - start, 49ms);
    std::thread later([&] {
        std::this_thread::sleep_for(50ms);
        pair.send(1);
    });
    EXPECT_TRUE(pair.subscriber.wait(5s));
    EXPECT_LT(Clock::now() - start, 4s);
    later.join();
    msg::Command received;
    EXPECT_TRUE(pair.subscriber.take(received));
    EXPECT_FALSE(pair.subscriber.wait(1ms)) << "nothing is left to take";
}

TEST(Qos, WaitSetWakesForEachAttachedTopic) {
    Node sender(options("eti-server"));
    Node receiver(options("receiver"));
    WaitSet wait_set;
    Publisher<msg::Command> commands(sender, topics::command);
    Publisher<msg::LiveMetrics> metrics(sender, topics::live_metrics);
    Subscriber<msg::Command> command(receiver, topics::command);
    Subscriber<msg::LiveMetrics> live(receiver, topics::live_metrics);
    command.notify(wait_set);
    live.notify(wait_set);
    ASSERT_TRUE(eventually([&] { return command.matched() == 1 && live.matched() == 1; }));
    EXPECT_FALSE(wait_set.wait(20ms)) << "nothing was sent";
    msg::Command received;
    msg::LiveMetrics measured;
    ASSERT_TRUE(commands.publish(example<msg::Command>()));
    EXPECT_TRUE(wait_set.wait(120s));
    EXPECT_TRUE(command.take(received));
    ASSERT_TRUE(metrics.publish(example<msg::LiveMetrics>()));
    EXPECT_TRUE(wait_set.wait(120s));
    EXPECT_TRUE(live.take(measured));
    EXPECT_FALSE(wait_set.wait(20ms)) << "it has rung for both";
    { const Subscriber<msg::Command> gone(std::move(command)); }
    ASSERT_TRUE(eventually([&] { return commands.matched() == 0; }));
    ASSERT_TRUE(metrics.publish(example<msg::LiveMetrics>()));
    EXPECT_TRUE(wait_set.wait(120s)) << "the one that is left rings on";
}

TEST(Qos, StuckReliableReaderDoesNotBlockWriter) {
    CommandPair pair;
    pair.connect();
    // The reader never takes. Keep last 64 at both ends drops the oldest instead of blocking; a write may
    // block for max_blocking_time (20 ms) at most, so 1000 blocking writes would take 20 s.
    const auto start = Clock::now();
    pair.send(1000);
    EXPECT_LT(Clock::now() - start, 10s);
}

TEST(Qos, HungWriterLosesLivelinessWithinLease) {
    Node server(options("eti-server"));
    Node client(options("client"));
    Publisher<msg::SessionStatus> publisher(server, topics::session_status);
    Subscriber<msg::SessionStatus> subscriber(client, topics::session_status);
    ASSERT_TRUE(eventually([&] { return publisher.matched() == 1 && subscriber.matched() == 1; }));
    ASSERT_TRUE(publisher.publish(example<msg::SessionStatus>()));
    ASSERT_TRUE(eventually([&] { return subscriber.alive(); }));
    // Asserted every 50 ms for three leases, it stays alive, unless other programs delay it by a lease.
    for (int i = 0; i < 20; ++i) {
        const auto last = Clock::now();
        std::this_thread::sleep_for(50ms);
        if (i % 2 == 0) {
            publisher.assert_liveliness();
        } else {
            ASSERT_TRUE(publisher.publish(example<msg::SessionStatus>()));
        }
        const bool alive = subscriber.alive();
        ASSERT_TRUE(alive || Clock::now() - last > 200ms) << "after " << i << " intervals";
    }
    ASSERT_TRUE(publisher.publish(example<msg::SessionStatus>()));
    const auto stopped = Clock::now();
    ASSERT_TRUE(eventually([&] { return subscriber.alive(); }));
    ASSERT_TRUE(eventually([&] { return !subscriber.alive(); }));
    const auto lost = Clock::now() - stopped;
    // Lease 300 ms, counted from the last assertion's arrival. The upper bound distinguishes it from the
    // library's own lease of 20 s and from none, on any machine.
    EXPECT_GT(lost, 280ms);
    EXPECT_LT(lost, 10s);
    EXPECT_EQ(subscriber.matched(), 1) << "hung is not gone";
    publisher.assert_liveliness();
    EXPECT_TRUE(eventually([&] { return subscriber.alive(); })) << "it does not come back";
}

TEST(Qos, DepartedWriterIsUnmatched) {
    Node client(options("client"));
    Subscriber<msg::SessionStatus> subscriber(client, topics::session_status);
    {
        Node server(options("eti-server"));
        Publisher<msg::SessionStatus> publisher(server, topics::session_status);
        ASSERT_TRUE(eventually([&] { return subscriber.matched() == 1; }));
    }
    EXPECT_TRUE(eventually([&] { return subscriber.matched() == 0 && !subscriber.alive(); }));
}

}  // namespace
}  // namespace eti::bus
