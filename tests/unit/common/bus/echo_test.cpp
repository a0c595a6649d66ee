// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/echo.hpp"

#include <gtest/gtest.h>

#include "common/bus/codec/convert.hpp"
#include "tests/unit/common/bus/bus_fixture.hpp"

namespace eti::bus {
namespace {

TEST(Echo, EveryNodeAnswersWithItsName) {
    Node one(options("eti-server")), two(options("eti-client"));
    EchoRequester asker(two);
    ASSERT_TRUE(eventually([&] {
        (void)asker.ask();
        asker.poll();
        return !asker.peers().empty();
    }));
    const PeerEcho& peer = asker.peers().begin()->second;
    EXPECT_EQ(peer.process, process_name());
    EXPECT_GE(peer.answers, 1u);
    EXPECT_GT(peer.min_round_trip_ms, 0.0);
    EXPECT_LT(peer.min_round_trip_ms, 1000.0);
    // The same clock: the offset's error is at most half a round trip.
    EXPECT_LE(std::abs(peer.clock_offset_ms), 0.5 * peer.min_round_trip_ms + 1e-3);
}

TEST(Echo, LatePollingDoesNotExtendRoundTrip) {
    Node one(options("eti-server")), two(options("eti-client"));
    EchoRequester asker(two);
    ASSERT_TRUE(eventually([&] {
        (void)asker.ask();
        asker.poll();
        return !asker.peers().empty();
    }));
    // The minimum of several: a busy machine may delay a single one.
    double least = 1e9;
    for (int i = 0; i < 20 && least >= 500.0; ++i) {
        (void)asker.ask();
        std::this_thread::sleep_for(1s);
        asker.poll();
        least = std::min(least, asker.peers().begin()->second.round_trip_ms);
    }
    EXPECT_LT(least, 500.0) << "half of the time for which nobody looked";
}

/// A request to a peer that the test answers by hand.
class ForeignEcho : public testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(eventually([&] {
            (void)asker.ask();
            return questions.take(question) && answers.matched() > 0;
        }));
    }

    Node node{options("eti-client")}, peer{options("other")};
    EchoRequester asker{node};
    Subscriber<msg::Echo> questions{peer, topics::echo_question};
    Publisher<msg::Echo> answers{peer, topics::echo_answer};
    msg::Echo question;
};

// RFC 5905, section 8: offset ((T2 - T1) + (T3 - T4)) / 2, delay (T4 - T1) - (T3 - T2).
TEST_F(ForeignEcho, YieldsTheClockOffset) {
    constexpr std::uint64_t ahead = 5'000'000'000;
    msg::Echo answer = question;
    answer.answerer("far:1");
    answer.heard_ns(question.asked_ns() + ahead + 1'000'000);
    answer.header().send_time_ns(question.asked_ns() + ahead + 3'000'000);
    ASSERT_TRUE(eventually([&] {
        answers.publish(answer);
        asker.poll();
        return asker.peers().contains("far:1");
    }));
    const PeerEcho& told = asker.peers().at("far:1");
    EXPECT_GT(told.clock_offset_ms, 5000.0 - told.min_round_trip_ms);
    EXPECT_LT(told.clock_offset_ms, 5000.0 + 2.0);
}

TEST_F(ForeignEcho, WithWrongNonceOrFutureTimeIsIgnored) {
    msg::Echo forged = question;
    forged.answerer("forged:1");
    forged.heard_ns(1);
    forged.nonce(question.nonce() + 1);
    answers.publish(forged);
    forged.nonce(question.nonce());
    forged.asked_ns(question.asked_ns() + 3'600'000'000'000);
    answers.publish(forged);
    std::this_thread::sleep_for(200ms);
    asker.poll();
    EXPECT_FALSE(asker.peers().contains("forged:1"));
}

TEST(Echo, AnswersAreRateLimited) {
    Node node(options("eti-server")), asking(options("other"));
    Publisher<msg::Echo> questions(asking, topics::echo_question);
    Subscriber<msg::Echo> answers(asking, topics::echo_answer);
    ASSERT_TRUE(eventually([&] { return questions.matched() >= 1 && answers.matched() >= 1; }));
    std::size_t answered = 0;
    msg::Echo message;
    const auto start = Clock::now();
    for (int i = 0; i < 5000; ++i) {
        msg::Echo question;
        question.asker("x");
        questions.publish(question);
        std::this_thread::sleep_for(100us);
        while (answers.take(message)) {
            ++answered;
        }
    }
    EXPECT_GT(answered, 0u);
    // Two nodes answer, each 200 at once and 200 a second.
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    EXPECT_LE(static_cast<double>(answered), 2.0 * 200.0 * (1.0 + seconds));
}

}  // namespace
}  // namespace eti::bus
