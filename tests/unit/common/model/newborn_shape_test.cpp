// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/newborn_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace eti {
namespace {

TEST(NewbornShape, GrowthFollowsThePublishedTable) {
    // Keen & Pearce 1988, rows 24, 32 and 40 weeks, means of boys and girls.
    EXPECT_NEAR(median_weight(24), 0.676, 1e-3);
    EXPECT_NEAR(median_weight(32), 0.5 * (1.894 + 1.523), 1e-3);
    EXPECT_NEAR(median_weight(40), 0.5 * (3.726 + 3.438), 1e-3);
    EXPECT_NEAR(mean_head_circumference(28).mean, 0.263, 1e-4);
    EXPECT_NEAR(mean_head_circumference(40).mean, 0.5 * (0.356 + 0.347), 1e-3);
}

TEST(NewbornShape, AgeInvertsWeightAndBothAreMonotonic) {
    for (float age = 22.5f; age < 42.0f; age += 0.5f) {
        EXPECT_NEAR(median_gestational_age(median_weight(age)), age, 1e-2);
        EXPECT_GT(median_weight(age), median_weight(age - 0.5f));
        EXPECT_GE(mean_head_circumference(age).mean, mean_head_circumference(age - 0.5f).mean);
    }
    EXPECT_FLOAT_EQ(median_gestational_age(0.1f), 22.0f) << "beyond the table its ends count";
    EXPECT_FLOAT_EQ(median_gestational_age(9.0f), 42.0f);
}

TEST(NewbornShape, EveryWeightInRangeHasAPlausibleAge) {
    for (float weight = shape_fields[0].low; weight <= shape_fields[0].high; weight += 0.1f) {
        NewbornShape shape;
        shape.weight = weight;
        shape.gestational_age = median_gestational_age(weight);
        EXPECT_EQ(implausibility(shape), "") << weight;
    }
}

TEST(NewbornShape, ImplausibleValueIsNamedWithItsRange) {
    NewbornShape shape;
    shape.tongue_scale = 3.0f;
    EXPECT_NE(implausibility(shape).find("tongue_scale is 3; expected 0.8 to 1.4"), std::string::npos)
        << implausibility(shape);
    shape = {};
    shape.weight = 1.0f;  // at 40 weeks
    EXPECT_NE(implausibility(shape).find("Give the age of that weight, 27"), std::string::npos)
        << implausibility(shape);
    shape = {};
    shape.larynx_anterior = std::nanf("");
    EXPECT_NE(implausibility(shape), "");
}

TEST(NewbornShape, VariantsDifferFromNormalAndArePlausible) {
    for (std::size_t k = 0; k < airway_variant_names.size(); ++k) {
        NewbornShape shape;
        apply(static_cast<AirwayVariant>(k), shape);
        EXPECT_EQ(implausibility(shape), "") << airway_variant_names[k];
        EXPECT_EQ(shape == NewbornShape(), k == 0) << airway_variant_names[k];
    }
}

}  // namespace
}  // namespace eti
