// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/guard/admission.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/common/bus/bus_fixture.hpp"
#include "tests/unit/common/bus/messages.hpp"

namespace eti::bus {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr ParticipantId a{1}, b{2}, stranger{9}, late{3};

WriterId writer_of(const ParticipantId& participant, std::uint8_t number) {
    return {participant, {0, 0, number, 3}};
}

class AdmissionTest : public testing::Test {
  protected:
    AdmissionTest() {
        admission_.on_discovered(a, "'eti-server' host:1", true);
        admission_.on_discovered(writer_of(a, 1), topics::session_status.name);
        admission_.on_discovered(writer_of(a, 2), topics::proxy.name);
    }
    Admission admission_{false};
};

TEST_F(AdmissionTest, FirstDiscoveredServerIsOwner) {
    EXPECT_EQ(admission_.owner(), a);
    EXPECT_FALSE(admission_.rejects(writer_of(a, 1)));
    EXPECT_FALSE(admission_.rejects(writer_of(a, 2)));
    EXPECT_FALSE(admission_.contested());
}

TEST_F(AdmissionTest, ServerTopicsAreRefusedFromOthers) {
    admission_.on_discovered(stranger, "", false);
    admission_.on_discovered(writer_of(stranger, 7), topics::proxy.name);
    admission_.on_discovered(writer_of(stranger, 8), topics::command.name);
    EXPECT_TRUE(admission_.rejects(writer_of(stranger, 7)));
    EXPECT_FALSE(admission_.rejects(writer_of(stranger, 8))) << "commands are anybody's";
    EXPECT_FALSE(admission_.contested()) << "nobody's status is doubted";
    EXPECT_THAT(admission_.take_log_lines(), Contains(HasSubstr("eti/proxy")));
    EXPECT_TRUE(admission_.take_log_lines().empty()) << "once";
}

TEST_F(AdmissionTest, SecondStatusWriterContestsTheSession) {
    admission_.on_discovered(writer_of(stranger, 7), topics::session_status.name);
    EXPECT_TRUE(admission_.contested());
    EXPECT_TRUE(admission_.rejects(writer_of(stranger, 7)));
    EXPECT_EQ(admission_.owner(), a);
    EXPECT_THAT(admission_.take_log_lines(), Contains(HasSubstr("forces are off")));
    admission_.on_removed(stranger);
    EXPECT_FALSE(admission_.contested());
    EXPECT_THAT(admission_.take_log_lines(), Contains(HasSubstr("one server again")));
}

TEST_F(AdmissionTest, RestartedServerTakesOverAfterKill) {
    admission_.on_liveliness_changed(writer_of(a, 1), true);
    admission_.on_discovered(b, "'eti-server' host:2", true);
    admission_.on_discovered(writer_of(b, 1), topics::session_status.name);
    EXPECT_EQ(admission_.owner(), a);
    EXPECT_TRUE(admission_.contested());
    admission_.on_liveliness_changed(writer_of(a, 1), false);
    EXPECT_EQ(admission_.owner(), b);
    EXPECT_FALSE(admission_.contested()) << "a killed server contests nothing";
    EXPECT_FALSE(admission_.rejects(writer_of(b, 1)));
    EXPECT_TRUE(admission_.rejects(writer_of(a, 2)));
}

// Its participant is known until its lease ends.
TEST_F(AdmissionTest, NextServerTakesOverAfterOrderlyEnd) {
    admission_.on_discovered(b, "'eti-server' host:2", true);
    admission_.on_removed(writer_of(a, 1));
    admission_.on_removed(writer_of(a, 2));
    EXPECT_EQ(admission_.owner(), b);
    admission_.on_discovered(writer_of(b, 1), topics::session_status.name);
    EXPECT_FALSE(admission_.rejects(writer_of(b, 1)));
    EXPECT_FALSE(admission_.contested());
}

TEST_F(AdmissionTest, PausedServerStaysOwner) {
    admission_.on_liveliness_changed(writer_of(a, 1), true);
    admission_.on_liveliness_changed(writer_of(a, 1), false);
    EXPECT_EQ(admission_.owner(), a);
    EXPECT_FALSE(admission_.rejects(writer_of(a, 2)));
}

TEST(Admission, WithoutServerOtherWritersAreRefused) {
    Admission admission(false);
    admission.on_discovered(writer_of(stranger, 7), topics::scene.name);
    EXPECT_TRUE(admission.rejects(writer_of(stranger, 7)));
    EXPECT_FALSE(admission.contested()) << "there is nothing to contest";
    admission.on_discovered(a, "'eti-server' host:1", true);
    admission.on_discovered(writer_of(a, 1), topics::scene.name);
    EXPECT_FALSE(admission.rejects(writer_of(a, 1)));
    EXPECT_TRUE(admission.rejects(writer_of(stranger, 7)));
}

TEST(Admission, ServerAcceptsOneWriterPerPose) {
    Admission server(true);
    server.on_discovered(writer_of(a, 1), topics::laryngoscope_pose.name);
    server.on_discovered(writer_of(b, 1), topics::laryngoscope_pose.name);
    server.on_discovered(writer_of(b, 2), topics::tube_pose.name);
    EXPECT_FALSE(server.rejects(writer_of(a, 1)));
    EXPECT_TRUE(server.rejects(writer_of(b, 1)));
    EXPECT_FALSE(server.rejects(writer_of(b, 2)));
    server.release_ownership(topics::laryngoscope_pose.name);
    EXPECT_TRUE(server.rejects(writer_of(a, 1)));
    EXPECT_FALSE(server.rejects(writer_of(b, 1)));
    server.on_removed(writer_of(b, 1));
    EXPECT_FALSE(server.rejects(writer_of(a, 1)));
}

class ReturningWriterTest : public testing::Test {
  protected:
    ReturningWriterTest() {
        server_.on_discovered(a, "'eti-tracker' host:1", false);
        server_.on_discovered(b, "'eti-tracker' host:2", false);
        server_.on_discovered(writer_of(a, 1), topics::tube_pose.name);
        server_.on_discovered(writer_of(b, 1), topics::tube_pose.name);
        (void)server_.take_log_lines();
    }

    /// Both send every 4 ms; time after which the first is accepted.
    std::chrono::milliseconds until_first_is_accepted(std::chrono::milliseconds longest) {
        for (std::chrono::milliseconds sent{0}; sent <= longest; sent += 4ms, now_ += 4ms) {
            const bool first_rejected = server_.rejects(writer_of(a, 1), now_);
            EXPECT_NE(first_rejected, server_.rejects(writer_of(b, 1), now_)) << "one of the two";
            if (!first_rejected) {
                return sent;
            }
        }
        return longest + 1ms;
    }

    Admission server_{true};
    Admission::Clock::time_point now_ = Admission::Clock::now();
};

TEST_F(ReturningWriterTest, FirstWriterGetsItsTopicBack) {
    server_.release_ownership(topics::tube_pose.name);
    EXPECT_FALSE(server_.rejects(writer_of(b, 1), now_));
    EXPECT_THAT(server_.take_log_lines(),
                Contains(HasSubstr("'eti-tracker' host:1 has stopped sending eti/tube_pose: 'eti-tracker' "
                                   "host:2 is followed")));
    EXPECT_TRUE(server_.take_log_lines().empty());
    EXPECT_TRUE(server_.rejects(writer_of(a, 1), now_)) << "a single sample";
    now_ += 600ms;
    EXPECT_EQ(until_first_is_accepted(1s), Admission::return_time);
    EXPECT_THAT(server_.take_log_lines(), Contains(HasSubstr("host:1 sends eti/tube_pose again")));
    EXPECT_TRUE(server_.rejects(writer_of(b, 1), now_));
}

TEST_F(ReturningWriterTest, UnsteadyWriterWaitsLongerEachTime) {
    std::chrono::milliseconds expected = Admission::return_time;
    for (int time = 0; time < 4; ++time, expected *= 2) {
        server_.release_ownership(topics::tube_pose.name);
        now_ += 600ms;
        EXPECT_EQ(until_first_is_accepted(10s), expected) << time;
    }
}

TEST_F(ReturningWriterTest, WriterThatResumesAloneKeepsItsTopic) {
    server_.on_removed(writer_of(b, 1));
    server_.release_ownership(topics::tube_pose.name);
    EXPECT_FALSE(server_.rejects(writer_of(a, 1), now_));
    server_.on_discovered(writer_of(b, 1), topics::tube_pose.name);
    EXPECT_FALSE(server_.rejects(writer_of(a, 1), now_)) << "it has sent since";
    EXPECT_TRUE(server_.rejects(writer_of(b, 1), now_));
}

TEST(Admission, ReleasedTopicAcceptsNextWriterImmediately) {
    Admission server(true);
    server.on_discovered(writer_of(a, 1), topics::tube_pose.name);
    server.release_ownership(topics::tube_pose.name);
    server.on_discovered(writer_of(b, 1), topics::tube_pose.name);
    EXPECT_FALSE(server.rejects(writer_of(b, 1)));
    EXPECT_TRUE(server.rejects(writer_of(a, 1)));
}

TEST(Admission, ServerIsHeardAmongManyStrangers) {
    Admission admission(false);
    for (std::uint8_t i = 0; i < 250; ++i) {
        admission.on_discovered({1, i}, "", false);
        admission.on_discovered({2, i}, "", false);
    }
    EXPECT_THAT(admission.take_log_lines(), testing::ElementsAre(HasSubstr("only servers are listened to")));
    admission.on_discovered(late, "'eti-server' host:1", true);
    EXPECT_EQ(admission.owner(), late);
}

TEST(Admission, WritersBeyondTheCapacityAreRefused) {
    Admission admission(false);
    for (std::uint32_t i = 0; i < 10'000; ++i) {
        admission.on_discovered(WriterId{{3}, {std::uint8_t(i), std::uint8_t(i >> 8), 1, 3}},
                                topics::proxy.name);
    }
    EXPECT_TRUE(admission.rejects(WriterId{{3}, {0, 0, 1, 3}}));
    const WriterId last{{3}, {std::uint8_t(9'999 & 0xff), std::uint8_t(9'999 >> 8), 1, 3}};
    EXPECT_TRUE(admission.rejects(last));
    admission.on_discovered(a, "'eti-server' host:1", true);
    admission.on_discovered(writer_of(a, 1), topics::proxy.name);
    EXPECT_TRUE(admission.rejects(last)) << "what is found later lets none of them in";
    EXPECT_FALSE(admission.rejects(writer_of(a, 1))) << "there is room for others";
}

TEST(AdmissionOverBus, ForeignSceneDoesNotReplaceTheServers) {
    Node stranger_node(options("stranger"));
    Publisher<msg::SceneDescription> forged(stranger_node, topics::scene);
    auto object = example<msg::SceneDescription>();
    object.object("frames");
    object.tissue(99);
    ASSERT_TRUE(forged.publish(object));

    Node client(options("eti-client"));
    Subscriber<msg::SceneDescription> scene(client, topics::scene);
    std::this_thread::sleep_for(300ms);

    Node server(options("eti-server"));
    Publisher<msg::SceneDescription> true_scene(server, topics::scene);
    object.tissue(1);
    ASSERT_TRUE(true_scene.publish(object));
    std::this_thread::sleep_for(300ms);
    object.tissue(98);
    ASSERT_TRUE(forged.publish(object));

    msg::SceneDescription received;
    ASSERT_TRUE(eventually([&] { return scene.take(received); }));
    EXPECT_EQ(received.tissue(), 1u);
    std::this_thread::sleep_for(300ms);
    EXPECT_FALSE(scene.take(received)) << "the forged ones come after nothing";
}

TEST(AdmissionOverBus, SecondStatusIsDetectedButNotDelivered) {
    Node server(options("eti-server")), client(options("eti-client"));
    Publisher<msg::SessionStatus> status(server, topics::session_status);
    Subscriber<msg::SessionStatus> heard(client, topics::session_status);
    auto own = example<msg::SessionStatus>();
    own.phase(msg::PHASE_RUNNING);
    msg::SessionStatus received;
    ASSERT_TRUE(eventually([&] { return status.publish(own) && heard.take(received); }));
    EXPECT_FALSE(client.contested());
    {
        Node forger(options("forger"));
        Publisher<msg::SessionStatus> forged(forger, topics::session_status);
        auto end = own;
        end.phase(msg::PHASE_FINISHED);
        ASSERT_TRUE(forged.publish(end));
        EXPECT_TRUE(eventually([&] { return client.contested(); }));
        ASSERT_TRUE(forged.publish(end));
        std::this_thread::sleep_for(300ms);
        while (heard.take(received)) {
            EXPECT_EQ(received.phase(), msg::PHASE_RUNNING);
        }
    }
    EXPECT_TRUE(eventually([&] { return !client.contested(); }));
}

}  // namespace
}  // namespace eti::bus
