// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/replay/step_comparison.hpp"

#include <gtest/gtest.h>

#include "common/model/pace.hpp"

namespace eti::app {
namespace {

session::StepRecord step(std::uint64_t number) {
    session::StepRecord record;
    record.step = number;
    record.time_ns = time_ns_of(number);
    record.tube_nodes.assign(3, Vec3f(1, 2, 3));
    return record;
}

bool holds_all(const std::string&, std::size_t) {
    return true;
}

TEST(StepComparison, IdenticalStepsAreEqual) {
    StepComparison comparison(3, holds_all);
    comparison.compare(step(1), step(1), 0);
    EXPECT_EQ(comparison.steps(), 1u);
    EXPECT_EQ(comparison.equal(), 1u) << "an eye that has not arrived is NaN in both";
    EXPECT_FALSE(comparison.first());
}

TEST(StepComparison, ReportsFirstOneBitDifference) {
    StepComparison comparison(3, holds_all);
    comparison.compare(step(1), step(1), 0);
    session::StepRecord other = step(2);
    other.tube_nodes[1].y() = std::nextafter(2.0f, 3.0f);
    comparison.compare(step(2), other, 1);
    session::StepRecord later = step(3);
    later.shell_force.x() = 1.0f;
    comparison.compare(step(3), later, 2);
    comparison.compare(step(4), step(4), 3);
    EXPECT_EQ(comparison.steps(), 4u);
    EXPECT_EQ(comparison.equal(), 2u);
    ASSERT_TRUE(comparison.first());
    EXPECT_EQ(comparison.first()->step, 2u);
    EXPECT_EQ(comparison.first()->series, "tools/tube_nodes");
    EXPECT_EQ(comparison.first()->recorded, 2.0);
    EXPECT_EQ(comparison.first()->simulated, static_cast<double>(other.tube_nodes[1].y()));
    EXPECT_NEAR(comparison.first()->time, 2.0 / 180.0, 1e-9);
}

TEST(StepComparison, DistinguishesSignedZeros) {
    StepComparison comparison(3, holds_all);
    session::StepRecord other = step(1);
    other.shell_force.z() = -0.0f;
    comparison.compare(step(1), other, 0);
    EXPECT_EQ(comparison.equal(), 0u);
}

TEST(StepComparison, IgnoresSeriesMissingFromFile) {
    StepComparison comparison(3, [](const std::string& series, std::size_t row) {
        return series != "tools/shell_force" || row != 0;
    });
    session::StepRecord other = step(1);
    other.shell_force.x() = 1.0f;
    comparison.compare(step(1), other, 0);
    EXPECT_EQ(comparison.equal(), 1u);
    other.step = 2;
    other.time_ns = time_ns_of(2);
    comparison.compare(step(2), other, 1);
    ASSERT_TRUE(comparison.first());
    EXPECT_EQ(comparison.first()->step, 2u);
}

}  // namespace
}  // namespace eti::app
