// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/scenario/setting.hpp"

#include <gmock/gmock.h>

#include "common/scenario/scenario.hpp"
#include "tests/support/error_of.hpp"

namespace eti {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

template <class Wish>
std::string setting_refusal(const Wish& wish) {
    return test::error_of<InputError>([&] { (void)wish(); });
}

TEST(Setting, RuntimeParameterIsStoredInSi) {
    const RuntimeParameterSetting stiffness = parse_runtime_parameter("tissue_stiffness_kpa=12.5");
    EXPECT_EQ(stiffness.field->name, "tissue_stiffness");
    EXPECT_FLOAT_EQ(stiffness.value, 12.5e3f);
    EXPECT_EQ(parse_runtime_parameter("view_clock=on").value, 1.0f);
    EXPECT_EQ(parse_runtime_parameter("view_clock=0").value, 0.0f);
}

TEST(Setting, InvalidSettingErrorNamesExpectation) {
    EXPECT_THAT(setting_refusal([] { return parse_runtime_parameter("jaw=1"); }),
                AllOf(HasSubstr("--set jaw=1"), HasSubstr("jaw_opening_deg (0 to 35)")));
    EXPECT_THAT(setting_refusal([] { return parse_runtime_parameter("tongue_scale"); }),
                HasSubstr("KEY=VALUE"));
    for (const char* typed :
         {"tongue_scale=", "tongue_scale=1.2x", "tongue_scale=on", "tongue_scale=nan", "tongue_scale=-inf"}) {
        EXPECT_THAT(setting_refusal([&] { return parse_runtime_parameter(typed); }),
                    AllOf(HasSubstr(typed), HasSubstr("a plain number")));
    }
}

TEST(Setting, ScenarioSettingReplacesOrAddsOneValue) {
    const std::string text = "name: small\npatient:\n  weight_kg: 2\n  jaw_opening_deg: 20\nsaliva: on\n";
    const auto parsed = [&](const char* typed) {
        return parse_scenario(with_setting(text, typed), "x.yaml");
    };
    EXPECT_FLOAT_EQ(parsed("patient.weight_kg=2.5").patient.shape.weight, 2.5f);
    EXPECT_FLOAT_EQ(parsed("patient.weight_kg=2.5").runtime_parameters.jaw_opening,
                    parsed("seed=7").runtime_parameters.jaw_opening);
    EXPECT_FALSE(parsed("saliva=off").saliva);
    EXPECT_EQ(parsed("seed=7").seed, 7u);
    EXPECT_EQ(parsed("physics.substeps=4").physics.substeps, 4) << "a section that the text does not have";
    EXPECT_EQ(parsed("seed=7").name, "small");
}

TEST(Setting, ScenarioSettingIsValidatedByScenario) {
    EXPECT_THAT(setting_refusal([] {
                    return parse_scenario(with_setting("saliva: on\n", "patient.weight=2"), "x.yaml");
                }),
                AllOf(HasSubstr("x.yaml"), HasSubstr("weight")));
    for (const char* typed : {"seed", "=3", ".seed=3", "patient.=3", ""}) {
        EXPECT_THAT(setting_refusal([&] { return with_setting("saliva: on\n", typed); }),
                    HasSubstr("KEY=VALUE"))
            << typed;
    }
    EXPECT_THAT(setting_refusal([] { return with_setting("saliva: on\n", "saliva.x=3"); }),
                HasSubstr("not a section"));
    EXPECT_THAT(setting_refusal([] { return with_setting("", "seed=3"); }), HasSubstr("empty"));
    EXPECT_THAT(setting_refusal([] { return with_setting("- a\n- b\n", "seed=3"); }), HasSubstr("scenario"));
}

}  // namespace
}  // namespace eti
