// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/output/recorder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/session/reader.hpp"
#include "common/session/repair/check.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/server/app/small_patient.hpp"

namespace eti::app {
namespace {

constexpr std::size_t frame_count = 40;
constexpr std::size_t tube_nodes = 5;

patient::Patient small_patient() {
    patient::Patient patient = patient_of_a_triangle(frame_count, Vec3f(0.1f, 0.2f, 0.3f));
    for (std::size_t i = 0; i < landmark_count; ++i) {
        patient.landmarks[i] = {Vec3f::Constant(static_cast<float>(i)), {{1, 0, 0, 0}, {1.0f, 0, 0, 0}}};
    }
    return patient;
}

class RecorderTest : public test::ScratchFolderTest {
  protected:
    RecorderTest() {
        snapshot.frames.resize(frame_count);
        snapshot.tube_nodes.assign(tube_nodes, Vec3f(1, 2, 3));
    }

    [[nodiscard]] Recorder recorder(bool saliva = false) const {
        session::SessionInfo info;
        info.session = "test";
        Scenario scenario;
        scenario.saliva = saliva;
        return {path, info, small_patient(), make_laryngoscope(Blade::miller_0), scenario, snapshot, true};
    }

    /// Advances the snapshot to step `number` at 180 Hz.
    void advance(std::uint64_t number) {
        snapshot.step = number;
        snapshot.time_ns = number * 1'000'000'000 / 180;
    }

    const std::filesystem::path path = folder / "run.eti.h5";
    scene::Snapshot snapshot;
    metrics::LiveMetrics live;
};

TEST_F(RecorderTest, WritesSnapshotValues) {
    snapshot.device.translation = {0.5f, 0.25f, 0.125f};
    snapshot.tube_grip.rotation = quaternion_from({0.3f, 0.2f, 0.1f});
    const scene::Snapshot start = snapshot;
    Recorder kept = recorder();
    advance(17);
    snapshot.device.translation = {1, 2, 3};
    snapshot.tube_grip.translation = {4, 5, 6};
    snapshot.proxy.rotation = quaternion_from({0.1f, 0.2f, 0.3f});
    snapshot.shell_force = {7, 8, 9};
    snapshot.shell_torque = {10, 11, 12};
    snapshot.tissue_force = {13, 14, 15};
    snapshot.tissue_torque = {16, 17, 18};
    snapshot.shell_contacts = {{Vec3f(1, 0, 0), Vec3f::UnitZ(), 2.0f, Tissue::upper_gum},
                               {Vec3f(0, 1, 0), Vec3f::UnitZ(), 1.0f, Tissue::upper_gum}};
    snapshot.tissue_contacts = {{Vec3f(0, 0, 2), Vec3f::Zero(), Vec3f(0, 3, 4), 1e-3f, Tissue::upper_gum},
                                {Vec3f(5, 0, 0), Vec3f::Zero(), Vec3f(0, 0, 1), 1e-3f, Tissue::tongue},
                                {Vec3f(7, 0, 0), Vec3f::Zero(), Vec3f(0, 0, -1), 1e-3f, Tissue::tongue}};
    snapshot.runtime_parameters.suction = 0.5f;
    snapshot.runtime_parameters.head_elevation = 0.4f;
    snapshot.runtime_parameters.jaw_opening = 0.3f;
    snapshot.runtime_parameters.table_angle = -0.2f;
    snapshot.runtime_parameters.head_scale = 1.1f;
    snapshot.runtime_parameters.tongue_scale = 1.2f;
    snapshot.runtime_parameters.tissue_stiffness = 9e3f;
    snapshot.runtime_parameters.secretion = 3.0f;
    snapshot.frames[1].rotation = quaternion_from({0.25f, 0.0f, 0.0f});
    snapshot.landmarks[4] = {22, 23, 24};
    live.measures.epiglottis_in_sight = 1.0f;
    live.measures.heart_rate_per_min = 140.0f;
    live.attempt = 3;
    live.attempt_running = true;
    live.measures.glottic_opening_percent = 42.0f;
    live.measures.gum_force_n = 2.5f;
    live.measures.tube_depth_past_glottis = -0.01f;
    AttemptMetrics parameters;
    parameters.time_s = 12.5;
    RigidTransform eye;
    eye.translation = {19, 20, 21};
    kept.record(snapshot, live, parameters, eye, Vec3f(1, 2, 3));
    advance(18);
    kept.record(snapshot, live, parameters, std::nullopt, Vec3f(4, 5, 6));
    kept.command(5, 17, "jaw_opening", 0.25, "trainee", 9);
    kept.event(6, "attempt", "began");
    kept.summary({1, 0.0, 1.0, {true, "the trachea was intubated"}, parameters});
    EXPECT_TRUE(kept.finish());

    const session::SessionReader reader(path);
    const auto steps = reader.steps();
    ASSERT_EQ(steps.size(), 2u);
    const session::StepRecord& first = steps[0];
    EXPECT_EQ(first.step, 17u);
    EXPECT_EQ(first.time_ns, 94'444'444u) << "17 / 180 s";
    EXPECT_EQ(first.laryngoscope.translation, Vec3f(1, 2, 3));
    EXPECT_EQ(first.tube_grip.translation, Vec3f(4, 5, 6));
    EXPECT_EQ(first.eye.translation, Vec3f(19, 20, 21));
    EXPECT_TRUE(std::isnan(steps[1].eye.translation.x()));
    EXPECT_THAT(first.eye_used, testing::ElementsAre(1.0f, 2.0f, 3.0f));
    EXPECT_THAT(steps[1].eye_used, testing::ElementsAre(4.0f, 5.0f, 6.0f));
    constexpr auto gum = static_cast<std::size_t>(Tissue::upper_gum), tongue = std::size_t{1},
                   larynx = std::size_t{3};
    EXPECT_EQ(first.loads.pressed[gum], 3.0f);
    EXPECT_THAT(first.loads.net[gum], testing::ElementsAre(0.0f, 3.0f, 4.0f));
    EXPECT_THAT(first.loads.place[gum], testing::ElementsAre(0.25f, 0.125f, 1.25f)) << "weights 2, 1 and 5 N";
    EXPECT_THAT(first.loads.net[tongue], testing::ElementsAre(0.0f, 0.0f, 0.0f)) << "pressed from both sides";
    EXPECT_EQ(first.loads.place[tongue][0], 6.0f);
    EXPECT_EQ(first.loads.pressed[larynx], 0.0f);
    EXPECT_TRUE(std::isnan(first.loads.place[larynx][0]));
    EXPECT_EQ(first.proxy.rotation.coeffs(), snapshot.proxy.rotation.coeffs());
    EXPECT_EQ(first.shell_force, Vec3f(7, 8, 9));
    EXPECT_EQ(first.shell_torque, Vec3f(10, 11, 12));
    EXPECT_EQ(first.tissue_force, Vec3f(13, 14, 15));
    EXPECT_EQ(first.tissue_torque, Vec3f(16, 17, 18));
    EXPECT_EQ(first.tube_nodes, snapshot.tube_nodes);
    EXPECT_EQ(first.runtime_parameters.suction, 0.5f);
    EXPECT_EQ(first.runtime_parameters.head_elevation, 0.4f);
    EXPECT_EQ(first.runtime_parameters.jaw_opening, 0.3f);
    EXPECT_EQ(first.runtime_parameters.table_angle, -0.2f);
    EXPECT_EQ(first.runtime_parameters.head_scale, 1.1f);
    EXPECT_EQ(first.runtime_parameters.tongue_scale, 1.2f);
    EXPECT_EQ(first.runtime_parameters.tissue_stiffness, 9e3f);
    EXPECT_EQ(first.runtime_parameters.secretion, 3.0f);
    EXPECT_EQ(first.attempt, 3u);
    EXPECT_TRUE(first.attempt_running);
    const Quatf& skull = snapshot.frames[1].rotation;
    EXPECT_THAT(first.skull_rotation, testing::ElementsAre(skull.w(), skull.x(), skull.y(), skull.z()));
    EXPECT_THAT(first.landmarks[4], testing::ElementsAre(22.0f, 23.0f, 24.0f));
    EXPECT_EQ(first.measures.epiglottis_in_sight, 1.0f);
    EXPECT_EQ(first.measures.heart_rate_per_min, 140.0f);
    EXPECT_TRUE(std::isnan(first.measures.oxygen_saturation_percent)) << "not simulated";
    EXPECT_EQ(first.measures.glottic_opening_percent, 42.0f);
    EXPECT_EQ(first.measures.gum_force_n, 2.5f);
    EXPECT_EQ(first.measures.tube_depth_past_glottis, -0.01f);
    EXPECT_EQ(first.metrics.time_s, 12.5);
    ASSERT_EQ(reader.commands().size(), 1u);
    EXPECT_EQ(reader.commands()[0].sender, "trainee");
    ASSERT_EQ(reader.events().size(), 1u);
    ASSERT_EQ(reader.summaries().size(), 1u);
    EXPECT_EQ(reader.summaries()[0].outcome.reason, "the trachea was intubated");
    EXPECT_DOUBLE_EQ(reader.summaries()[0].began, 1e-9 * static_cast<double>(first.time_ns))
        << "on the steps' axis";
    EXPECT_DOUBLE_EQ(reader.summaries()[0].ended, 1e-9 * static_cast<double>(first.time_ns) + 1.0);

    const session::SceneRecord scene = reader.scene();
    ASSERT_EQ(scene.surfaces.size(), 1u);
    EXPECT_EQ(scene.surfaces[0].tissue, Tissue::tongue);
    ASSERT_EQ(scene.landmarks.size(), landmark_count);
    EXPECT_EQ(scene.landmarks[14].name, "carina");
    EXPECT_EQ(scene.landmarks[14].rest, Vec3f::Constant(14.0f));
    EXPECT_EQ(scene.blade, name_of(Blade::miller_0));
    EXPECT_FALSE(scene.laryngoscope.triangles.empty());
    EXPECT_EQ(scene.laryngoscope_start.translation, start.device.translation);
    EXPECT_EQ(scene.laryngoscope_start.rotation.coeffs(), start.device.rotation.coeffs());
    EXPECT_EQ(scene.tube_grip_start.rotation.coeffs(), start.tube_grip.rotation.coeffs());
    EXPECT_FALSE(reader.info().version.empty());
    EXPECT_FALSE(reader.info().build.empty());
    EXPECT_EQ(reader.info().start_time.size(), std::string("2024-02-29T12:00:00Z").size());
    EXPECT_TRUE(session::check(path).is_valid());
}

TEST_F(RecorderTest, DeformationStoresMovedFramesAt15Hertz) {
    Recorder kept = recorder();
    // Frame 3 creeps by 7 um a step, so it exceeds the quantum of 20 um in every period of 12 steps; frame 4
    // creeps by 0.7 um and exceeds it in every third; the others rest.
    constexpr std::uint64_t steps = 180;
    for (std::uint64_t i = 0; i < steps; ++i) {
        advance(i);
        snapshot.frames[3].centre.x() = 7e-6f * static_cast<float>(i);
        snapshot.frames[4].centre.x() = 0.7e-6f * static_cast<float>(i);
        kept.record(snapshot, live, {}, std::nullopt, Vec3f::Zero());
    }
    EXPECT_TRUE(kept.finish());
    const auto deformations = session::SessionReader(path).deformations();
    ASSERT_EQ(deformations.size(), 15u);
    EXPECT_EQ(deformations[0].frame.size(), frame_count) << "the first record places every frame";
    for (std::size_t k = 1; k < deformations.size(); ++k) {
        const auto& frames = deformations[k].frame;
        EXPECT_EQ(deformations[k].time_ns, 12 * k * 1'000'000'000 / 180);
        EXPECT_EQ(frames, k % 3 == 0 ? (std::vector<std::uint16_t>{3, 4}) : (std::vector<std::uint16_t>{3}));
    }
}

TEST_F(RecorderTest, LiquidIsStoredAt15Hertz) {
    Recorder kept = recorder(true);
    snapshot.saliva.on = true;
    for (std::uint64_t i = 0; i < 180; ++i) {
        advance(i);
        snapshot.saliva.positions.assign(i, Vec3f(0.01f, -0.02f, 1e-4f * static_cast<float>(i)));
        kept.record(snapshot, live, {}, std::nullopt, Vec3f::Zero());
    }
    EXPECT_TRUE(kept.finish());
    const auto fluids = session::SessionReader(path).fluids();
    ASSERT_EQ(fluids.size(), 15u);
    for (std::size_t k = 1; k < fluids.size(); ++k) {
        EXPECT_EQ(fluids[k].time_ns, 12 * k * 1'000'000'000 / 180);
        ASSERT_EQ(fluids[k].position.size(), 12 * k);
        // Half a cell of 2^-16 m in each of three directions.
        const Vec3f truth(0.01f, -0.02f, 1e-4f * static_cast<float>(12 * k));
        EXPECT_LE((fluids[k].position.front() - truth).norm(), 0.87f * 0x1p-16f);
    }
}

TEST_F(RecorderTest, ReplayErrorIsWithinQuantum) {
    Recorder kept = recorder();
    std::vector<std::vector<FramePose>> truth;
    for (std::uint64_t i = 0; i < 360; ++i) {
        advance(i);
        for (std::size_t f = 0; f < frame_count; ++f) {
            const float phase = 0.01f * static_cast<float>(i) * static_cast<float>(f % 7);
            snapshot.frames[f].centre =
                Vec3f(0.1f, -0.05f, 0.02f) + 1e-3f * Vec3f(std::sin(phase), std::cos(phase), 0);
            snapshot.frames[f].rotation = quaternion_from({0.1f * std::sin(phase), 0.0f, 0.02f * phase});
        }
        kept.record(snapshot, live, {}, std::nullopt, Vec3f::Zero());
        if (i % 12 == 0) {
            truth.push_back(snapshot.frames);
        }
    }
    EXPECT_TRUE(kept.finish());
    std::vector<FramePose> replayed(frame_count);
    const auto deformations = session::SessionReader(path).deformations();
    ASSERT_EQ(deformations.size(), truth.size());
    for (std::size_t k = 0; k < truth.size(); ++k) {
        for (std::size_t j = 0; j < deformations[k].frame.size(); ++j) {
            replayed[deformations[k].frame[j]] = deformations[k].pose[j];
        }
        for (std::size_t f = 0; f < frame_count; ++f) {
            // The quantum, plus the grid: half a cell of 2^-20 m in each of three directions, and half a
            // cell of 2^-15 in each of four components of the quaternion, which is half the angle.
            EXPECT_LE((replayed[f].centre - truth[k][f].centre).norm(),
                      frame_shift_quantum + 0.9f * 0x1p-20f);
            const Quatf rotation = replayed[f].rotation.normalized();
            EXPECT_LE(rotation_vector(rotation.conjugate() * truth[k][f].rotation).norm(),
                      frame_turn_quantum + 2.0f * 0x1p-15f);
        }
    }
}

}  // namespace
}  // namespace eti::app
