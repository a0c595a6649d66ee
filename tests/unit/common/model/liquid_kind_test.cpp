// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/liquid_kind.hpp"

#include <gtest/gtest.h>

namespace eti {
namespace {

TEST(LiquidKind, NameRoundTrips) {
    for (const LiquidKind kind : {LiquidKind::saliva, LiquidKind::blood}) {
        EXPECT_EQ(liquid_kind_named(name_of(kind)), kind);
    }
    EXPECT_EQ(liquid_kind_named("of a newer server"), LiquidKind::saliva);
    EXPECT_EQ(liquid_kind_named(""), LiquidKind::saliva) << "an older server does not say";
}

// Reference: Wesolowski & Mlynarczak 2019, 30 healthy subjects at 37 degrees: 1063.56 kg/m^3,
// 3.352 +- 0.360 mPa s, 52.41 +- 2.62 mN/m.
TEST(LiquidKind, BloodIsWithinMeasuredRange) {
    const LiquidProperties& blood = properties_of(LiquidKind::blood);
    EXPECT_NEAR(blood.density, 1063.56f, 1.0f);
    EXPECT_NEAR(blood.viscosity * blood.density, 3.352e-3f, 0.360e-3f);
    EXPECT_NEAR(blood.surface_tension, 52.41e-3f, 2.62e-3f);
    EXPECT_LT(blood.viscosity, properties_of(LiquidKind::saliva).viscosity);
    EXPECT_LT(blood.foaming, 0.1f * properties_of(LiquidKind::saliva).foaming);
}

}  // namespace
}  // namespace eti
