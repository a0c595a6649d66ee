// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/assessment_thread.hpp"
#include "common/model/pace.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "common/session/reader.hpp"
#include "tests/unit/server/metrics/airway_shapes.hpp"

namespace eti::app {
namespace {

constexpr std::uint64_t step_count = 900;

patient::Patient bare_patient() {
    patient::Patient patient;
    patient.weight = 3.0f;
    patient.frame_rest_centre.assign(patient::bone_count, Vec3f::Zero());
    return patient;
}

/// The blade enters and leaves the mouth within each 300 steps, crossing lines of sight.
void go_on(scene::Snapshot& s) {
    ++s.step;
    s.time_ns = s.step * 1'000'000'000ULL / steps_per_second;
    const auto phase = static_cast<float>(s.step % 300) / 300.0f;
    const float depth = 0.08f * std::sin(3.14159265f * phase);
    s.proxy.translation = Vec3f(0.0f, -0.13f + depth, 0.5f * depth - 0.01f);
    s.proxy.rotation = quaternion_from(Vec3f(-1.5707963f, 0.0f, 0.0f));
    s.glottis_contour = {{-0.003f, 0.033f, -0.06f}, {0.003f, 0.033f, -0.06f}, {0.0f, 0.038f, -0.06f}};
}

struct Judged {
    std::vector<session::StepRecord> steps;
    std::vector<session::CommandRecord> commands;
    std::vector<session::StateRecord> states;
    std::vector<session::EventRecord> events;
    std::vector<session::SummaryRecord> summaries;
    double ended_at = 0.0;
};

Judged judged(bool beside) {
    const auto file = std::filesystem::temp_directory_path() /
                      ("eti_judge_" + std::to_string(::getpid()) + (beside ? "_beside" : "_at_once") + ".h5");
    std::filesystem::remove(file);
    const patient::Patient patient = bare_patient();
    const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    Judged out;
    {
        Assessor assessor(patient, scope, Scenario{});
        session::SessionInfo info;
        info.session = "test";
        scene::Snapshot snapshot = metrics::test::plain_snapshot();
        snapshot.tube_nodes = {Vec3f(-0.12f, -0.25f, 0.1f), Vec3f(-0.12f, -0.2f, 0.1f)};
        Recorder recorder(file, info, patient, scope, Scenario{}, snapshot, true);
        AssessmentThread judge(assessor, &recorder, nullptr, beside);
        for (std::uint64_t k = 0; k < step_count; ++k) {
            go_on(snapshot);
            if (k % 100 == 50) {
                judge.log(
                    {snapshot.time_ns, snapshot.step, "suction", 1.0, "pad", static_cast<std::uint32_t>(k)});
            }
            if (snapshot.step % steps_per_second == 0) {
                judge.log(session::StateRecord{snapshot.time_ns, snapshot.step, "0123456789abcdef"});
            }
            judge.submit(snapshot, std::nullopt);
        }
        judge.log(session::StateRecord{snapshot.time_ns, snapshot.step, "fedcba9876543210"});
        judge.finish();
        out.ended_at = judge.ended_at();
        EXPECT_TRUE(recorder.finish());
    }
    const session::SessionReader reader(file);
    out.steps = reader.steps();
    out.commands = reader.commands();
    out.states = reader.states();
    out.events = reader.events();
    out.summaries = reader.summaries();
    std::filesystem::remove(file);
    return out;
}

bool same(double a, double b) {
    return a == b || (std::isnan(a) && std::isnan(b));
}

TEST(AssessmentThread, AsynchronousResultsMatchSynchronous) {
    const Judged at_once = judged(false), beside = judged(true);
    ASSERT_EQ(at_once.steps.size(), step_count);
    ASSERT_EQ(beside.steps.size(), step_count) << "more than may wait, and none is left out";
    bool seen = false, hidden = false;
    for (std::size_t i = 0; i < step_count; ++i) {
        const session::StepRecord &a = at_once.steps[i], &b = beside.steps[i];
        ASSERT_EQ(a.step, b.step);
        ASSERT_EQ(a.proxy.translation, b.proxy.translation);
        ASSERT_EQ(a.attempt, b.attempt);
        ASSERT_EQ(a.attempt_running, b.attempt_running);
        ASSERT_EQ(a.measures.glottic_opening_percent, b.measures.glottic_opening_percent);
        seen = seen || a.measures.glottic_opening_percent > 50.0f;
        hidden = hidden || a.measures.glottic_opening_percent < 50.0f;
        for (const MetricField& field : metric_fields) {
            ASSERT_TRUE(same(a.metrics.*field.value, b.metrics.*field.value)) << "step " << a.step;
        }
    }
    EXPECT_TRUE(seen && hidden) << "else the view tells nothing";
    ASSERT_EQ(at_once.events.size(), beside.events.size());
    for (std::size_t i = 0; i < at_once.events.size(); ++i) {
        EXPECT_EQ(at_once.events[i].text, beside.events[i].text);
        EXPECT_EQ(at_once.events[i].time_ns, beside.events[i].time_ns);
    }
    ASSERT_EQ(at_once.summaries.size(), 4u) << "three attempts and the run";
    ASSERT_EQ(beside.summaries.size(), 4u);
    ASSERT_EQ(beside.commands.size(), 9u);
    EXPECT_EQ(beside.commands[8].id, 850u);
    ASSERT_EQ(beside.states.size(), step_count / steps_per_second + 1);
    EXPECT_EQ(beside.states[0].step, steps_per_second);
    EXPECT_EQ(beside.states[0].hash, "0123456789abcdef");
    EXPECT_EQ(beside.states.back().hash, "fedcba9876543210") << "no step came after it";
    EXPECT_GT(at_once.ended_at, 4.0);
    EXPECT_EQ(at_once.ended_at, beside.ended_at);
}

TEST(AssessmentThread, RunningAttemptHasNoEndTime) {
    const patient::Patient patient = bare_patient();
    const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    Assessor assessor(patient, scope, Scenario{});
    AssessmentThread judge(assessor, nullptr, nullptr, false);
    scene::Snapshot snapshot = metrics::test::plain_snapshot();
    const auto run_to = [&](std::uint64_t step) {
        while (snapshot.step < step) {
            go_on(snapshot);
            judge.submit(snapshot, std::nullopt);
        }
    };
    EXPECT_LT(judge.ended_at(), 0.0);
    run_to(150);
    ASSERT_TRUE(assessor.metrics().live().attempt_running);
    EXPECT_LT(judge.ended_at(), 0.0);
    run_to(299);
    EXPECT_GT(judge.ended_at(), 150.0 / 180.0);
    run_to(450);
    EXPECT_LT(judge.ended_at(), 0.0) << "the second goes on";
}

}  // namespace
}  // namespace eti::app
