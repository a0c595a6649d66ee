// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/organ_check.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace eti::segmentation {
namespace {

/// A head whose cranium has a radius of 40 mm about (0, 0, 80) mm, with balls and boxes for organs.
class OrganCheckTest : public ::testing::Test {
  protected:
    OrganCheckTest() {
        geometry.size = {60, 60, 60};
        geometry.step = 2e-3 * Eigen::Matrix3d::Identity();
        geometry.origin = Vec3d(-59e-3, -59e-3, -19e-3);
        head.in_plane = Vec3d(0, 0, 80e-3);
        head.size = 40e-3;
    }
    /// A ball; all in mm.
    [[nodiscard]] imaging::Bits ball(double x, double y, double z, double radius) const {
        imaging::Bits bits(geometry.count());
        for (std::size_t i = 0; i < bits.size(); ++i) {
            const auto [a, b, c] = geometry.coordinates(i);
            bits[i] = (geometry.point(a, b, c) - 1e-3 * Vec3d(x, y, z)).norm() < 1e-3 * radius ? 1 : 0;
        }
        return bits;
    }
    void expect(const imaging::Bits& organ, const OrganLimits& limits, const std::string& said) const {
        const std::string why = OrganCheck(geometry, head, airway).implausibility(organ, limits);
        if (said.empty()) {
            EXPECT_EQ(why, "");
        } else {
            EXPECT_NE(why.find(said), std::string::npos) << why;
        }
    }

    imaging::Geometry geometry;
    HeadPose head;
    imaging::Bits airway = imaging::Bits();
};

TEST_F(OrganCheckTest, AcceptsExpectedSizeAndPosition) {
    airway = ball(0, 10, 20, 8);
    // 4/3 pi r^3: 8.2, 22.4 and 7.2 ml in a head whose cube is 64 ml.
    expect(ball(0, -30, 20, 12.5), mandible_limits, "");
    expect(ball(0, -10, 20, 17.5), tongue_limits, "");
    expect(ball(0, 40, 20, 12), spine_limits, "");
    expect({}, mandible_limits, "");
}

TEST_F(OrganCheckTest, RefusesWrongSizeOrPosition) {
    airway = ball(0, 10, 20, 8);
    expect(ball(0, -10, 20, 25), mandible_limits, "65");                                  // 65 ml; at most 32
    expect(ball(0, -30, 20, 5), mandible_limits, "ml were found; expected 1.3 to 32.0");  // at least 1.3
    expect(ball(15, -30, 20, 12.5), mandible_limits, "15 mm beside");
    expect(ball(8, -30, 20, 12.5), mandible_limits, "on one side");
    expect(ball(0, -30, 60, 12.5), mandible_limits, "20 mm below");
    expect(ball(0, 40, 20, 12.5), mandible_limits, "30 mm behind");
    expect(ball(0, -30, 20, 12), spine_limits, "40 mm in front of");
    expect(ball(0, 40, 20, 4), spine_limits, "ml were found; expected 0.5 to 51.2");  // the least is 0.5
    head.size = 0.0;
    expect(ball(0, -10, 20, 25), mandible_limits, "");
}

TEST_F(OrganCheckTest, FindsOrgansOutOfOrder) {
    const OrganCheck check(geometry, head, airway);
    EXPECT_EQ(check.out_of_order(ball(0, -30, 20, 9), ball(0, -10, 20, 9), ball(0, 40, 20, 9)), "");
    EXPECT_EQ(check.out_of_order(ball(0, -30, 20, 9), {}, ball(0, 40, 20, 9)), "");
    EXPECT_NE(check.out_of_order(ball(0, 45, 20, 9), {}, ball(0, 20, 20, 9)).find("mandible"),
              std::string::npos);
    EXPECT_NE(check.out_of_order({}, ball(0, 45, 20, 9), ball(0, 20, 20, 9)).find("tongue"),
              std::string::npos);
}

TEST_F(OrganCheckTest, FindsSeedsOutsideTheirOrgan) {
    imaging::Mask labels{geometry, std::vector<std::uint8_t>(geometry.count(), value_of(Label::soft))};
    const imaging::Bits mandible = ball(0, -30, 20, 10);
    const imaging::Bits spine = ball(0, 40, 20, 10);
    for (std::size_t i = 0; i < mandible.size(); ++i) {
        labels.value[i] = mandible[i] != 0 ? value_of(Label::mandible)
                          : spine[i] != 0  ? value_of(Label::spine)
                                           : labels.value[i];
    }
    const Vec3d chin(0, -30e-3, 20e-3);
    const Vec3d vertebra(0, 40e-3, 20e-3);
    std::vector<std::string> said;
    find_stray_seeds(labels, {{"mandible", {chin}}, {"spine", {vertebra}}, {"tongue", {chin}}}, {}, said);
    EXPECT_TRUE(said.empty()) << said.front() << ": a tongue that is not there has no label";
    find_stray_seeds(labels, {{"tongue", {chin}}}, {{"tongue", {chin}}}, said);
    ASSERT_EQ(said.size(), 1u) << "points given for nothing are not passed over";
    EXPECT_NE(said.front().find("resulted in no label"), std::string::npos) << said.front();
    said.clear();
    const Points wrong = {{"mandible", {chin}}, {"spine", {vertebra, vertebra, chin}}};
    find_stray_seeds(labels, wrong, wrong, said);
    ASSERT_EQ(said.size(), 1u);
    EXPECT_EQ(said.front().rfind("1 of 3 points 'spine' that were given", 0), 0u) << said.front();
    EXPECT_NE(said.front().find("in mandible"), std::string::npos) << said.front();

    // Of ten points of the jaw one may lie in the skull, at the jaw's border, but none in the skull far from
    // it.
    const imaging::Bits joint = ball(0, -30, 36, 5);
    const imaging::Bits crown = ball(0, -30, 60, 5);
    for (std::size_t i = 0; i < joint.size(); ++i) {
        const bool bone = labels.value[i] == value_of(Label::soft) && (joint[i] != 0 || crown[i] != 0);
        labels.value[i] = bone ? value_of(Label::bone) : labels.value[i];
    }
    const Vec3d border(0, -30e-3, 34e-3);
    Points jaw = {{"mandible", std::vector<Vec3d>(9, chin)}};
    jaw["mandible"].push_back(border);
    said.clear();
    find_stray_seeds(labels, jaw, jaw, said);
    EXPECT_TRUE(said.empty()) << said.front();

    jaw["mandible"].back() = Vec3d(0, -30e-3, 60e-3);
    find_stray_seeds(labels, jaw, {}, said);
    EXPECT_TRUE(said.empty()) << said.front() << ": placed, and one of ten";
    find_stray_seeds(labels, jaw, jaw, said);
    ASSERT_EQ(said.size(), 1u);
    EXPECT_EQ(said.front().rfind("1 of 10 points 'mandible' that were given", 0), 0u) << said.front();

    jaw["mandible"].back() = border;
    jaw["mandible"].insert(jaw["mandible"].end(), 2, border);
    said.clear();
    find_stray_seeds(labels, jaw, jaw, said);
    EXPECT_EQ(said.size(), 1u) << "three of twelve are more than a fifth";
}

}  // namespace
}  // namespace eti::segmentation
