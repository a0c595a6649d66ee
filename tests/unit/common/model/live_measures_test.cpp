// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/live_measures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace eti {
namespace {

TEST(LiveMeasures, TableNamesEveryMemberOnce) {
    EXPECT_EQ(sizeof(LiveMeasures), live_measure_fields.size() * sizeof(float));
    std::set<std::string_view> keys;
    for (const LiveMeasureField& field : live_measure_fields) {
        keys.insert(field.key);
        EXPECT_EQ(&live_measure(field.value), &field) << "two rows of " << field.key;
    }
    EXPECT_EQ(keys.size(), live_measure_fields.size());
}

TEST(LiveMeasures, RowsCanBeShown) {
    const LiveMeasures initial;
    for (const LiveMeasureField& field : live_measure_fields) {
        EXPECT_FALSE(field.label.empty() || field.help.empty()) << field.key;
        EXPECT_EQ(field.plot_high > 0.0f, !field.short_label.empty()) << field.key;
        EXPECT_GT(field.per_unit, 0.0f) << field.key;
        EXPECT_TRUE(field.optional || std::isfinite(initial.*field.value)) << field.key;
    }
}

}  // namespace
}  // namespace eti
