// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/replay/recorded_states.hpp"

#include <gmock/gmock.h>

#include "common/model/pace.hpp"
#include "server/app/output/recorder.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/server/app/small_patient.hpp"

namespace eti::app {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t frame_count = 12;
// As derived in the recorder's test: the quantum by which a frame must move, and half a cell of the file's
// grid.
constexpr float shift_tolerance = frame_shift_quantum + 0.9f * 0x1p-20f;
constexpr float turn_tolerance = frame_turn_quantum + 2.0f * 0x1p-15f;

patient::Patient patient_with_landmarks() {
    patient::Patient patient = patient_of_a_triangle(frame_count, Vec3f(0.01f, 0.02f, 0.03f));
    for (std::size_t i = 0; i < landmark_count; ++i) {
        patient.landmarks[i] = {Vec3f::Constant(0.01f * static_cast<float>(i)),
                                {{static_cast<std::uint16_t>(i % frame_count), 0, 0, 0}, {1.0f, 0, 0, 0}}};
    }
    patient.glottis_contour.assign(3, patient.landmarks[5]);
    return patient;
}

class RecordedStatesTest : public test::ScratchFolderTest {
  protected:
    RecordedStatesTest() {
        snapshot.frames.resize(frame_count);
        for (FramePose& frame : snapshot.frames) {
            frame.centre = Vec3f(0.01f, 0.02f, 0.03f);
        }
        snapshot.tube_nodes.assign(3, Vec3f(0.1f, 0.2f, 0.3f));
    }

    /// Records steps 1 to `count`, each modified by `change`.
    template <class Change>
    void record(std::uint64_t count, const Change& change, bool saliva = false) {
        session::SessionInfo info;
        info.session = "test";
        Scenario scenario;
        scenario.saliva = saliva;
        Recorder kept(path, info, patient_with_landmarks(), make_laryngoscope(Blade::miller_0), scenario,
                      snapshot, true);
        snapshot.saliva.on = saliva;
        for (std::uint64_t step = 1; step <= count; ++step) {
            snapshot.step = step;
            snapshot.time_ns = time_ns_of(step);
            change(static_cast<float>(step));
            kept.record(snapshot, live, parameters, std::nullopt, Vec3f::Zero());
            truth.push_back(snapshot);
        }
        ASSERT_TRUE(kept.finish());
    }

    const std::filesystem::path path = folder / "run.eti.h5";
    scene::Snapshot snapshot;
    metrics::LiveMetrics live;
    AttemptMetrics parameters;
    std::vector<scene::Snapshot> truth;
};

TEST_F(RecordedStatesTest, ToolsAreExactAndTissueIsInterpolated) {
    record(360, [&](float step) {
        snapshot.proxy.translation.x() = 1e-4f * step;
        snapshot.tube_nodes[1].y() = 2e-4f * step;
        snapshot.runtime_parameters.jaw_opening = 1e-3f * step;
        // A steady motion is interpolated evenly: states between records are correct, too.
        snapshot.frames[3].centre.x() = 5e-5f * step;
        snapshot.frames[4].rotation = quaternion_from({0.0f, 2e-3f * step, 0.0f});
    });
    const Recording recording = read_recording(path);
    RecordedStates states(recording, Scenario{});
    ASSERT_EQ(states.size(), truth.size());
    // Forwards, then backwards: the result does not depend on the previous query.
    for (std::size_t k = 0; k < 2 * truth.size(); ++k) {
        const std::size_t row = k < truth.size() ? k : 2 * truth.size() - 1 - k;
        const scene::Snapshot& was = truth[row];
        const scene::Snapshot& is = states.at(row);
        ASSERT_EQ(is.step, was.step);
        EXPECT_EQ(is.proxy.translation, was.proxy.translation);
        EXPECT_EQ(is.tube_nodes, was.tube_nodes);
        EXPECT_EQ(is.runtime_parameters.jaw_opening, was.runtime_parameters.jaw_opening);
        EXPECT_LE((is.frames[3].centre - was.frames[3].centre).norm(), shift_tolerance) << row;
        EXPECT_LE(rotation_vector(is.frames[4].rotation.conjugate() * was.frames[4].rotation).norm(),
                  turn_tolerance)
            << row;
        EXPECT_LE((is.frames[5].centre - was.frames[5].centre).norm(), shift_tolerance);
    }
    // A point moves with its frame.
    const scene::Snapshot& last = states.at(truth.size() - 1);
    EXPECT_NEAR(last.landmarks[3].x(), 0.03f - 0.01f + 5e-5f * 360.0f, shift_tolerance);
}

TEST_F(RecordedStatesTest, RestingTissueDoesNotMoveEarly) {
    // At rest for two seconds, during which nothing is recorded of it, then within a period 1 mm away.
    record(420, [&](float step) { snapshot.frames[2].centre.y() = step > 372.0f ? 1e-3f : 0.0f; });
    const Recording recording = read_recording(path);
    RecordedStates states(recording, Scenario{});
    for (std::size_t row = 12; row < 370; ++row) {
        ASSERT_EQ(states.at(row).frames[2].centre.y(), 0.0f) << row;
    }
    EXPECT_NEAR(states.at(400).frames[2].centre.y(), 1e-3f, 1e-6f);
}

TEST_F(RecordedStatesTest, MetricsMatchRecording) {
    record(120, [&](float step) {
        live.attempt = 2;
        live.attempt_running = step < 100.0f;
        live.measures.gum_force_n = step > 50.0f ? 0.1f * step : 0.0f;
        live.measures.glottic_opening_percent = step;
        live.measures.tube_depth_past_glottis = -0.01f;
        parameters.time_s = static_cast<double>(step) / 180.0;
        if (step > 50.0f) {
            snapshot.shell_contacts = {
                {Vec3f(0.01f, 0.02f, 0.03f), Vec3f::UnitY(), 0.1f * step, Tissue::upper_gum}};
        }
    });
    const Recording recording = read_recording(path);
    RecordedStates states(recording, Scenario{});
    const AttemptStatus& late = states.status(110);
    EXPECT_EQ(late.attempt, 2u);
    EXPECT_FALSE(late.attempt_running);
    EXPECT_EQ(late.measures.gum_force_n, 0.1f * 111.0f);
    EXPECT_EQ(late.measures.glottic_opening_percent, 111.0f);
    EXPECT_EQ(late.measures.tube_depth_past_glottis, -0.01f);
    EXPECT_EQ(late.metrics.time_s, 111.0 / 180.0);
    EXPECT_FALSE(late.eye);
    EXPECT_TRUE(states.status(10).attempt_running);
    EXPECT_TRUE(states.at(10).shell_contacts.empty());
    ASSERT_EQ(states.at(110).shell_contacts.size(), 1u);
    EXPECT_EQ(states.at(110).shell_contacts[0].force, 0.1f * 111.0f);
    EXPECT_EQ(states.at(110).shell_contacts[0].tissue, Tissue::upper_gum);
    EXPECT_LT((states.at(110).shell_contacts[0].position - Vec3f(0.01f, 0.02f, 0.03f)).norm(), 1e-8f);
}

TEST_F(RecordedStatesTest, LiquidIsHeldUntilNextRecord) {
    record(
        60,
        [&](float step) {
            snapshot.saliva.positions.assign(static_cast<std::size_t>(step),
                                             Vec3f(0.01f, 0.02f, 1e-3f * step));
        },
        true);
    const Recording recording = read_recording(path);
    RecordedStates states(recording, Scenario{});
    for (const std::size_t row : {12u, 17u, 22u}) {  // steps 13, 18 and 23: liquid was recorded at step 12
        const scene::SalivaState& liquid = states.at(row).saliva;
        EXPECT_TRUE(liquid.on);
        ASSERT_EQ(liquid.positions.size(), 12u);
        EXPECT_NEAR(liquid.positions[0].z(), 12e-3f, 0x1p-16f);
        EXPECT_TRUE((liquid.lower.array() <= liquid.positions[0].array()).all());
        EXPECT_TRUE((liquid.upper.array() >= liquid.positions[0].array()).all());
    }
    EXPECT_EQ(states.at(23).saliva.positions.size(), 24u);
}

TEST_F(RecordedStatesTest, RefusesInvalidRecording) {
    record(30, [](float) {});
    Recording recording = read_recording(path);
    const auto refusal = [&] {
        return test::error_of<InputError>([&] { const RecordedStates states(recording, Scenario{}); });
    };
    EXPECT_EQ(refusal(), "");
    recording.deformations[0].frame[0] = frame_count;
    EXPECT_THAT(refusal(), HasSubstr("frame 12 of 12"));
    recording.deformations[0].frame[0] = 0;
    recording.deformations[0].pose[0].rotation.coeffs().setZero();
    EXPECT_THAT(refusal(), HasSubstr("invalid pose of frame 0"));
    recording.deformations.clear();
    std::swap(recording.steps.front(), recording.steps.back());
    EXPECT_THAT(refusal(), HasSubstr("are not in order"));
    recording.scene.surfaces.clear();
    EXPECT_THAT(refusal(), HasSubstr("no surfaces"));
}

}  // namespace
}  // namespace eti::app
