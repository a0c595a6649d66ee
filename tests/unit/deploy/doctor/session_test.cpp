// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "deploy/doctor/session.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "common/bus/discovery/rediscovery_counter.hpp"

namespace eti::doctor {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::Field;
using testing::HasSubstr;
using testing::Not;

auto mend(const std::string& remedy) {
    return Contains(
        AllOf(Field(&Finding::state, State::problem), Field(&Finding::remedy, HasSubstr(remedy))));
}

SessionReport whole() {
    SessionReport report;
    report.server = true;
    report.peers = {{"eti-server", "lab:1", "0.1.0", bus::protocol, true, {0.2, 0.3, 0.4}, 0.1, 0.1}};
    report.topics = {{"eti/deformation", 1000, 0, 0.0}};
    return report;
}

TEST(ChunkLossCounter, CompleteSequenceHasNoLoss) {
    ChunkLossCounter loss(2);
    for (std::uint32_t number = 10; number < 30; number += 2) {
        for (int chunk = 0; chunk < 3; ++chunk) {
            loss.note(number, 3);
        }
    }
    EXPECT_EQ(loss.arrived(), 30u);
    EXPECT_EQ(loss.lost(), 0u);
}

TEST(ChunkLossCounter, MissingChunksAndWholeStatesCount) {
    ChunkLossCounter loss(2);
    const auto state = [&](std::uint32_t number, int chunks) {
        for (int chunk = 0; chunk < chunks; ++chunk) {
            loss.note(number, 3);
        }
    };
    state(10, 1);  // joined in its middle: earlier samples are unknown
    state(12, 3);
    state(14, 2);  // one chunk lost
    state(20, 3);  // the two states before it were lost: six chunks
    state(22, 3);
    EXPECT_EQ(loss.arrived(), 12u);
    EXPECT_EQ(loss.lost(), 7u);
    EXPECT_DOUBLE_EQ(loss.percent(), 100.0 * 7 / 19);
}

TEST(ChunkLossCounter, LateChunkIsNotLost) {
    ChunkLossCounter loss(2);
    loss.note(10, 1);
    loss.note(14, 1);
    EXPECT_EQ(loss.lost(), 1u);
    loss.note(12, 1);
    EXPECT_EQ(loss.lost(), 0u);
}

TEST(ChunkLossCounter, StateAStepEarlyOrLateIsNotLost) {
    ChunkLossCounter loss(6);
    for (const std::uint32_t number : {6u, 12u, 19u, 24u, 30u}) {
        loss.note(number, 1);
    }
    EXPECT_EQ(loss.lost(), 0u);
}

TEST(JudgeSession, HealthySessionPasses) {
    EXPECT_THAT(diagnose_session(whole(), {}), Each(Field(&Finding::state, State::ok)));
}

TEST(JudgeSession, MissingServerNamesOptionsAndOtherSession) {
    SessionReport report;
    report.elsewhere = {"morning"};
    const Findings findings = diagnose_session(report, {});
    EXPECT_THAT(findings, mend("--network"));
    EXPECT_THAT(findings, Contains(Field(&Finding::text, HasSubstr("'morning'"))));
    EXPECT_THAT(findings, Each(Field(&Finding::remedy, Not(HasSubstr("eti-doctor")))));
}

TEST(JudgeSession, SecondServerIsNamed) {
    SessionReport report = whole();
    report.contested = true;
    EXPECT_THAT(diagnose_session(report, {}), mend("--identity"));
}

TEST(JudgeSession, PeerOfAnotherProtocolIsNamed) {
    SessionReport report = whole();
    report.peers[0].protocol = bus::protocol - 1;
    EXPECT_THAT(diagnose_session(report, {}), mend("same version"));
}

TEST(JudgeSession, SilentPeerIsNamed) {
    SessionReport report = whole();
    report.peers[0].round_trips_ms.clear();
    EXPECT_THAT(diagnose_session(report, {}), mend("firewall"));
}

TEST(JudgeSession, SlowPeerIsNamed) {
    SessionReport report = whole();
    report.peers[0].round_trips_ms = {19.0, 21.0, 22.0};
    EXPECT_THAT(diagnose_session(report, {}), mend("cable"));
}

TEST(JudgeSession, ClockOffsetBeyondItsErrorIsANote) {
    SessionReport report = whole();
    report.peers[0].clock_offset_ms = -40.0;
    EXPECT_THAT(diagnose_session(report, {}), Contains(AllOf(Field(&Finding::state, State::info),
                                                             Field(&Finding::remedy, HasSubstr("chrony")))));
    report.peers[0].error_ms = 30.0;
    EXPECT_THAT(diagnose_session(report, {}), Each(Field(&Finding::state, State::ok)));
}

TEST(JudgeSession, LossAndSilenceOfATopicAreNamed) {
    SessionReport report = whole();
    report.topics = {{"eti/deformation", 900, 100, 10.0}, {"eti/live_metrics", 0, 0, 0.0}};
    EXPECT_THAT(diagnose_session(report, {}), mend("socket buffers"));
    EXPECT_THAT(diagnose_session(report, {}), Contains(Field(&Finding::text, "no messages")));
}

TEST(JudgeSession, ForgedDeparturesAreNamed) {
    SessionReport report = whole();
    report.seconds = 5.0;
    report.rediscoveries.after_departure = 5;
    EXPECT_THAT(diagnose_session(report, {}), mend("forges departures"));
}

TEST(JudgeSession, InterruptedConnectionIsNamed) {
    SessionReport report = whole();
    report.rediscoveries.after_silence = 1;
    EXPECT_THAT(diagnose_session(report, {}), mend("cable and switch"));
}

TEST(JudgeSession, ThinLinkIsNamedWithTheRateNeeded) {
    SessionReport report = whole();
    // 1 Mbit/s of 5.
    report.topics = {{"eti/deformation", 200, 800, 80.0, 0.9}, {"eti/live_metrics", 20, 80, 80.0, 0.1}};
    const Findings findings = diagnose_session(report, {});
    EXPECT_THAT(findings, mend("a client needs 10 Mbit/s"));
    EXPECT_THAT(findings, Contains(Field(&Finding::text, HasSubstr("1.0 Mbit/s arrive of 5.0"))));
    report.rediscoveries.after_departure = 3;
    EXPECT_THAT(diagnose_session(report, {}), Not(mend("a client needs")));
    report.rediscoveries = {};
    report.topics = {{"eti/deformation", 990, 10, 1.0, 4.5}};
    EXPECT_THAT(diagnose_session(report, {}), Each(Field(&Finding::state, State::ok)));
}

TEST(RediscoveryCounter, CountsReturnsByTheirCause) {
    bus::RediscoveryCounter<int> counter;
    counter.on_discovered(1);
    counter.on_gone(1, true);
    counter.on_gone(2, false);
    counter.on_gone(3, true);  // and stays away
    EXPECT_EQ(counter.counts().after_departure, 0u);
    counter.on_discovered(1);
    counter.on_discovered(1);  // an update of what is known
    counter.on_discovered(2);
    EXPECT_EQ(counter.counts().after_departure, 1u);
    EXPECT_EQ(counter.counts().after_silence, 1u);
}

TEST(Percentile, MatchesSortedValues) {
    std::vector<double> values(101);
    std::iota(values.rbegin(), values.rend(), 0.0);
    EXPECT_EQ(percentile(values, 0.0), 0.0);
    EXPECT_EQ(percentile(values, 0.5), 50.0);
    EXPECT_EQ(percentile(values, 0.99), 99.0);
    EXPECT_EQ(percentile({}, 0.5), 0.0);
}

}  // namespace
}  // namespace eti::doctor
