// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "common/operator/track_player.hpp"
#include "common/scenario/data_file.hpp"
#include "tests/unit/common/operator/newborn_landmarks.hpp"

namespace eti {
namespace {

std::vector<std::filesystem::path> shipped() {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(ETI_SOURCE_DIR "/deploy/data/operators")) {
        files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

// Depth of the tube's tip past the glottis, along the trachea [m].
float depth_of(const Vec3f& tip, const Landmarks& points) {
    const Vec3f glottis = at(points, Landmark::glottis);
    return (tip - glottis).dot((at(points, Landmark::trachea_mid) - glottis).normalized());
}

struct Travel {
    Eigen::AlignedBox3f grip;  ///< extent of the hand's positions on the handle [m]
    double time = 0;           ///< [s]
    float deepest_tip =
        -1;  ///< of the laryngoscope, along the superior-inferior axis below the upper gum [m]
    bool tube_gave_up = false;
};

// Both hands over static landmarks. `view` [%] is their view once the blade's tip is behind the tongue.
Travel perform(const OperatorScript& script, Blade blade, float view) {
    const float length = make_laryngoscope(blade).blade_length;
    const Tube tube;
    TrackPlayer left(script.laryngoscope, length, script.tremor, script.reaction, script.seed);
    TrackPlayer right(script.tube, tube.grip_from_tip, script.tremor, script.reaction, script.seed + 1);
    Observation seen;
    seen.landmarks = newborn_landmarks();
    seen.tube_depth_rule = 0.095f;
    Travel travel;
    const Vec3f gum = at(seen.landmarks, Landmark::upper_gum);
    while (!(left.finished() && right.finished()) && seen.time < 120) {
        const RigidTransform scope = left.wanted(seen);
        seen.proxy = scope;
        // Grip of the hand on the handle: 50 mm from the blade.
        travel.grip.extend(scope * Vec3f(0, 0.05f, 0));
        const Vec3f tip = scope * Vec3f(0, 0, length);
        travel.deepest_tip = std::max(travel.deepest_tip, gum.z() - tip.z());
        seen.glottic_opening_percent = gum.z() - tip.z() > 0.02f ? view : 0.0f;
        seen.tube_tip = right.wanted(seen) * Vec3f(0, 0, tube.grip_from_tip);
        seen.tube_depth_past_glottis = depth_of(seen.tube_tip, seen.landmarks);
        seen.time += 0.005;
    }
    travel.time = seen.time;
    travel.tube_gave_up = right.aborted();
    return travel;
}

TEST(ShippedOperators, Exist) {
    std::vector<std::string> names;
    for (const auto& file : shipped()) {
        names.push_back(file.stem().string());
    }
    for (const char* name : {"expert", "novice", "no_lift", "oesophageal"}) {
        EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
    }
}

TEST(ShippedOperators, LoadUnderTheirOwnNames) {
    for (const auto& file : shipped()) {
        const OperatorScript script = load_operator(file);
        EXPECT_EQ(script.name, file.stem().string());
        EXPECT_FALSE(script.description.empty()) << file;
        EXPECT_GT(script.tremor, 0) << file << ": every hand trembles";
    }
}

// The workspace of the paper's device, 160 x 120 x 120 mm: width, height, depth. The device faces the
// operator, who sits at the head of a supine patient. Its width lies along the patient's left-right axis, its
// height along the anterior-posterior one, its depth along the superior-inferior one. It can be placed
// anywhere, so only the extent of the travel counts.
TEST(ShippedOperators, LaryngoscopeStaysInTheDevicesWorkspace) {
    for (const auto& file : shipped()) {
        const OperatorScript script = load_operator(file);
        for (const Blade blade : {Blade::miller_0, Blade::miller_1}) {
            for (const float view : {0.0f, 100.0f}) {
                const Travel travel = perform(script, blade, view);
                const Vec3f extent = travel.grip.sizes();
                EXPECT_LT(extent.x(), 0.160f) << file << ", " << name_of(blade);
                EXPECT_LT(extent.y(), 0.120f) << file << ", " << name_of(blade);
                EXPECT_LT(extent.z(), 0.120f) << file << ", " << name_of(blade);
                EXPECT_GT(extent.norm(), 0.03f) << file << " hardly moves";
            }
        }
    }
}

TEST(ShippedOperators, EndWithAndWithoutGlottisView) {
    for (const auto& file : shipped()) {
        const OperatorScript script = load_operator(file);
        for (const float view : {0.0f, 100.0f}) {
            const Travel travel = perform(script, Blade::miller_1, view);
            EXPECT_LT(travel.time, 119) << file << " never ends, view " << view;
            EXPECT_GT(travel.deepest_tip, 0.03f) << file << " does not reach the throat";
        }
    }
}

TEST(ShippedOperators, VisualOperatorsDoNotAdvanceWithoutView) {
    for (const char* name : {"expert", "no_lift"}) {
        const OperatorScript script = load_operator(find_data_file(name, "operators"));
        EXPECT_TRUE(perform(script, Blade::miller_1, 0).tube_gave_up) << name;
        EXPECT_FALSE(perform(script, Blade::miller_1, 100).tube_gave_up) << name;
    }
    const OperatorScript blind = load_operator(find_data_file("oesophageal", "operators"));
    EXPECT_FALSE(perform(blind, Blade::miller_1, 0).tube_gave_up);
}

// The control run must differ from the expert in the lift alone, otherwise it proves nothing: without the
// stages that lift or lower, both are the same.
TEST(ShippedOperators, NoLiftDiffersFromExpertInLiftAlone) {
    const OperatorScript expert = load_operator(find_data_file("expert", "operators"));
    const OperatorScript control = load_operator(find_data_file("no_lift", "operators"));
    EXPECT_EQ(control.tremor, expert.tremor);
    EXPECT_EQ(control.reaction, expert.reaction);
    EXPECT_EQ(control.laryngoscope.lean, expert.laryngoscope.lean);
    EXPECT_EQ(control.seed, expert.seed);
    EXPECT_EQ(control.tube.weight, expert.tube.weight);
    const auto expect_alike = [](const std::vector<Stage>& left, const std::vector<Stage>& right) {
        ASSERT_EQ(left.size(), right.size());
        for (std::size_t i = 0; i < left.size(); ++i) {
            const Stage& a = left[i];
            const Stage& b = right[i];
            EXPECT_EQ(a.name, b.name);
            EXPECT_TRUE(a.tip_at == b.tip_at && a.tip_offset == b.tip_offset &&
                        a.tip_fixed_offset == b.tip_fixed_offset && a.axis_from == b.axis_from &&
                        a.axis_from_offset == b.axis_from_offset &&
                        a.axis_from_fixed_offset == b.axis_from_fixed_offset &&
                        a.axis_to_tip == b.axis_to_tip && a.axis_to == b.axis_to && a.keep == b.keep &&
                        a.follow == b.follow && a.steer == b.steer)
                << "another pose in '" << a.name << "'";
            EXPECT_TRUE(a.lift == b.lift && a.advance == b.advance && a.pitch == b.pitch && a.yaw == b.yaw &&
                        a.roll == b.roll && a.depth_at_lip == b.depth_at_lip &&
                        a.depth_by_rule == b.depth_by_rule)
                << "another move in '" << a.name << "'";
            EXPECT_TRUE(
                a.until_view_percent == b.until_view_percent && a.until_tube_depth == b.until_tube_depth &&
                a.until_tube_aside == b.until_tube_aside && a.until_blade_past == b.until_blade_past &&
                a.until_time == b.until_time && a.abort_on_timeout == b.abort_on_timeout)
                << "another condition in '" << a.name << "'";
        }
    };
    std::vector<Stage> rest = expert.laryngoscope.stages;
    std::erase_if(rest, [](const Stage& s) { return s.lift != 0; });
    EXPECT_LT(rest.size(), expert.laryngoscope.stages.size()) << "the expert does not lift";
    expect_alike(control.laryngoscope.stages, rest);
    expect_alike(control.tube.stages, expert.tube.stages);
}

}  // namespace
}  // namespace eti
