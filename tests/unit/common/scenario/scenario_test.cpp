// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/scenario/scenario.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string>

#include "common/math/units.hpp"
#include "tests/support/error_of.hpp"

namespace eti {
namespace {

Scenario read(const std::string& text) {
    return parse_scenario(text, "baby.yaml");
}

std::string scenario_refusal(const std::string& text) {
    return test::error_of<InputError>([&] { (void)read(text); });
}

testing::AssertionResult refused(const std::string& text, std::initializer_list<const char*> words) {
    const std::string message = scenario_refusal(text);
    for (const char* word : words) {
        if (message.find(word) == std::string::npos) {
            return testing::AssertionFailure() << "no '" << word << "' in: '" << message << "'";
        }
    }
    return testing::AssertionSuccess() << message;
}

TEST(Scenario, EveryKeyArrivesInItsUnit) {
    const Scenario s = read(R"(
name: baby
description: tries every key
debriefing: was the view held?
patient: {weight_kg: 1.1, gestational_age_weeks: 28, tongue_scale: 1.15, head_elevation_deg: 25,
          jaw_opening_deg: 20, muscle_tone: 0.5, tissue_stiffness_kpa: 9}
laryngoscope: {blade: miller_0}
tube: {inner_diameter_mm: 2.5, length_mm: 150, youngs_modulus_mpa: 12, grip_from_tip_mm: 90, curve_radius_mm: 130}
physics: {substeps: 6, spacing_mm: 1.5, fine_spacing_mm: 0.75, region_mm: 12, sleep: off, bones_yield: on}
assistant: {hand_on_jaw_nm_per_rad: 2, hand_on_head_nm_per_rad: 0, laryngeal_pressure_back_n: 3,
            laryngeal_pressure_up_n: -1, laryngeal_pressure_right_n: 2}
saliva: on
view: {enhanced: on}
time_limit_s: 20
vital_signs: on
inspired_oxygen_percent: 40
seed: 42
)");
    EXPECT_EQ(s.name, "baby");
    EXPECT_EQ(s.description, "tries every key");
    EXPECT_EQ(s.debriefing, "was the view held?");
    EXPECT_FLOAT_EQ(s.patient.shape.weight, 1.1f);
    EXPECT_FLOAT_EQ(s.patient.shape.gestational_age, 28);
    EXPECT_FLOAT_EQ(s.patient.shape.tongue_scale, 1.15f);
    EXPECT_FLOAT_EQ(s.runtime_parameters.head_elevation, 25 * degree);
    EXPECT_FLOAT_EQ(s.runtime_parameters.jaw_opening, 20 * degree);
    EXPECT_FLOAT_EQ(s.runtime_parameters.tissue_stiffness, 9e3f);
    EXPECT_EQ(s.runtime_parameters.muscle_tone, 0.5f);
    EXPECT_EQ(s.assistant.hand_on_jaw, 2.0f);
    EXPECT_EQ(s.assistant.hand_on_head, 0.0f);
    EXPECT_EQ(s.runtime_parameters.laryngeal_pressure_back, 3.0f);
    EXPECT_EQ(s.runtime_parameters.laryngeal_pressure_up, -1.0f);
    EXPECT_EQ(s.runtime_parameters.laryngeal_pressure_right, 2.0f);
    EXPECT_EQ(s.blade, Blade::miller_0);
    EXPECT_FLOAT_EQ(s.tube.inner_diameter, 2.5e-3f);
    EXPECT_FLOAT_EQ(s.tube.outer_diameter, 3.6e-3f) << "the outer diameter follows the inner";
    EXPECT_FLOAT_EQ(s.tube.length, 0.15f);
    EXPECT_FLOAT_EQ(s.tube.youngs_modulus, 12e6f);
    EXPECT_FLOAT_EQ(s.tube.grip_from_tip, 0.09f);
    EXPECT_FLOAT_EQ(s.tube.curve_radius, 0.13f);
    EXPECT_EQ(s.physics.substeps, 6);
    EXPECT_FALSE(s.physics.sleep);
    EXPECT_FLOAT_EQ(s.physics.spacing, 1.5e-3f);
    EXPECT_FLOAT_EQ(s.physics.fine_spacing, 0.75e-3f);
    EXPECT_FLOAT_EQ(s.physics.region, 12e-3f);
    EXPECT_TRUE(s.saliva);
    EXPECT_EQ(s.runtime_parameters.view_enhanced, 1.0f);
    EXPECT_FLOAT_EQ(s.time_limit, 20);
    EXPECT_TRUE(s.vital_signs);
    EXPECT_FLOAT_EQ(s.inspired_oxygen, 0.4f);
    EXPECT_EQ(s.seed, 42u);
}

TEST(Scenario, OmittedKeysKeepTheirDefault) {
    const Scenario s = read("seed: 2\n"), defaults;
    EXPECT_EQ(s.name, "baby");
    EXPECT_EQ(s.text, "seed: 2\n");
    EXPECT_EQ(s.patient.shape.weight, defaults.patient.shape.weight);
    EXPECT_EQ(s.blade, defaults.blade);
    EXPECT_EQ(s.physics.substeps, defaults.physics.substeps);
    EXPECT_TRUE(s.physics.sleep);
    EXPECT_EQ(s.time_limit, defaults.time_limit);
    EXPECT_FALSE(s.vital_signs) << "as in the paper";
    EXPECT_THROW(read("inspired_oxygen_percent: 20\n"), InputError);
    EXPECT_EQ(s.saliva, defaults.saliva);
    EXPECT_FALSE(read("saliva: on\n").saliva_standby);
    EXPECT_TRUE(read("saliva: standby\n").saliva);
    EXPECT_TRUE(read("saliva: standby\n").saliva_standby);
    EXPECT_EQ(read("saliva: on\n").liquid, LiquidKind::saliva);
    EXPECT_EQ(read("saliva: on\nliquid: blood\n").liquid, LiquidKind::blood);
    EXPECT_FLOAT_EQ(read("patient: {table_angle_deg: -15}\n").runtime_parameters.table_angle, -15 * degree);
}

TEST(Scenario, ErrorsNamePlaceFindingExpectationAndRemedy) {
    EXPECT_TRUE(refused("seed: 1\npatient:\n  weight_kg: 35\n",
                        {"baby.yaml:3", "'patient.weight_kg'", "'35'", "0.5 to 4.5"}));
    EXPECT_TRUE(
        refused("patient: {weight_kg: heavy}\n", {"baby.yaml:1", "weight_kg", "'heavy'", "a number"}));
    EXPECT_TRUE(refused("patient: {weight_kg: 3.5 kg}\n", {"'3.5 kg'", "write the number without its unit"}));
    EXPECT_TRUE(refused("\n\nwieght_kg: 3\n", {"baby.yaml:3", "unknown key 'wieght_kg'", "patient"}));
    EXPECT_TRUE(refused("patient: {wieght_kg: 3}\n", {"did you mean 'weight_kg'?"}));
    EXPECT_TRUE(refused("patient: 3\n", {"baby.yaml:1", "patient", "mapping"}));
    EXPECT_TRUE(refused("patient: {weight_kg: [3]}\n", {"weight_kg", "a list"}));
    EXPECT_TRUE(refused("patient: {weight_kg: }\n", {"weight_kg", "nothing"}));
    EXPECT_TRUE(refused("patient: {weight_kg: 3, weight_kg: 4}\n", {"weight_kg", "twice"}));
    EXPECT_TRUE(refused("saliva: maybe\n", {"saliva", "'maybe'", "off, on, standby"}));
    EXPECT_TRUE(refused("saliva: on\nliquid: milk\n", {"baby.yaml:2", "liquid", "'milk'", "saliva, blood"}));
    EXPECT_TRUE(refused("liquid: blood\n", {"liquid", "found blood", "without either there is no liquid"}));
    EXPECT_TRUE(refused("seed: -1\n", {"seed", "'-1'", "whole number"}));
    EXPECT_TRUE(refused("seed: 1.5\n", {"seed", "'1.5'"}));
    EXPECT_TRUE(refused("physics: {substeps: 0}\n", {"substeps", "1 to 64"}));
    EXPECT_TRUE(refused("physics: {substeps: 4.0}\n", {"substeps", "whole number"}));
    EXPECT_TRUE(
        refused("laryngoscope: {blade: macintosh}\n", {"blade", "'macintosh'", "miller_0, miller_1"}));
    EXPECT_TRUE(
        refused("tube: {length_mm: 120, grip_from_tip_mm: 150}\n", {"grip_from_tip_mm", "150", "120"}));
    EXPECT_TRUE(
        refused("physics: {spacing_mm: 1, fine_spacing_mm: 1.5}\n", {"fine_spacing_mm", "spacing_mm"}));
    EXPECT_TRUE(refused("name: \"two\\nlines\"\n", {"name", "one line"}));
}

TEST(Scenario, AssistantNeedsBonesThatYield) {
    EXPECT_TRUE(refused("physics: {bones_yield: on}\nassistant: {hand_on_jaw_nm_per_rad: 11}\n",
                        {"baby.yaml:2", "'assistant.hand_on_jaw_nm_per_rad'", "'11'", "0 to 10"}));
    EXPECT_TRUE(refused("physics: {bones_yield: on}\nassistant: {laryngeal_pressure_back_n: -1}\n",
                        {"'assistant.laryngeal_pressure_back_n'", "0 to 10"}));
    EXPECT_TRUE(refused("physics: {bones_yield: off}\nassistant: {hand_on_head_nm_per_rad: 2}\n",
                        {"baby.yaml:2", "hand_on_head_nm_per_rad", "found 2", "physics.bones_yield: on"}));
    EXPECT_TRUE(refused("assistant: {laryngeal_pressure_up_n: 2}\nphysics: {bones_yield: off}\n",
                        {"baby.yaml:1", "laryngeal_pressure_up_n", "physics.bones_yield: on"}));
    EXPECT_TRUE(refused("patient:\n  muscle_tone: 0.5\nphysics: {bones_yield: off}\n",
                        {"baby.yaml:2", "'patient.muscle_tone'", "found 0.5", "physics.bones_yield: on"}));
    EXPECT_EQ(read("patient: {muscle_tone: 0}\nphysics: {bones_yield: off}\n").runtime_parameters.muscle_tone,
              0.0f);
}

TEST(Scenario, AgeFollowsWeightAndBothMustFit) {
    EXPECT_NEAR(read("patient: {weight_kg: 1.126}\n").patient.shape.gestational_age, 28.0f, 1e-3);
    EXPECT_FLOAT_EQ(
        read("patient: {weight_kg: 1.1, gestational_age_weeks: 30}\n").patient.shape.gestational_age, 30.0f);
    EXPECT_TRUE(refused("patient: {weight_kg: 1.1, gestational_age_weeks: 40}\n",
                        {"baby.yaml:1", "patient.weight_kg", "1.1", "1.79 to 6.09", "omit the age"}));
}

TEST(Scenario, VariantSetsOmittedKeys) {
    EXPECT_LT(read("patient: {variant: micrognathia}\n").patient.shape.mandible_scale, 1.0f);
    const NewbornShape both =
        read("patient: {variant: anterior-larynx, larynx_anterior_mm: 1}\n").patient.shape;
    EXPECT_FLOAT_EQ(both.larynx_anterior, 1e-3f);
    EXPECT_GT(both.larynx_superior, 0.0f);
    EXPECT_TRUE(refused("patient: {variant: giant}\n", {"variant", "'giant'", "micrognathia"}));
}

TEST(Scenario, ModelPathIsRelativeAndFixesTheShape) {
    EXPECT_EQ(parse_scenario("patient: {model: baby.h5}\n", "some/where/baby.yaml").patient.model,
              "some/where/baby.h5");
    EXPECT_EQ(parse_scenario("patient: {model: /tmp/baby.h5}\n", "some/baby.yaml").patient.model,
              "/tmp/baby.h5");
    EXPECT_EQ(read("patient: {model: a.h5, head_elevation_deg: 20}\n").runtime_parameters.head_elevation,
              20 * degree);
    for (const char* key :
         {"weight_kg: 3", "variant: normal", "tissue_stiffness_kpa: 9", "tongue_scale: 1"}) {
        EXPECT_TRUE(refused(std::string("patient: {model: a.h5, ") + key + "}\n",
                            {"patient.", "build another model"}))
            << key;
    }
    EXPECT_TRUE(
        refused("patient: {model: a.h5}\nphysics: {spacing_mm: 3}\n", {"spacing_mm", "patient.model"}));
}

TEST(Scenario, MissingModelIsNamedWithItsLine) {
    const std::string file = testing::TempDir() + "eti_scenario_without_its_model.yaml";
    std::ofstream(file) << "name: baby\npatient:\n  model: no/such/model.h5\n";
    const std::string message = test::error_of<InputError>([&] { (void)load_scenario(file); });
    for (const std::string& word :
         {file + ":3", std::string("patient.model"), testing::TempDir() + "no/such/model.h5",
          std::string("nothing"), std::string("eti-anatomy build")}) {
        EXPECT_NE(message.find(word), std::string::npos) << word << ": " << message;
    }
    std::filesystem::remove(file);
}

TEST(Scenario, IndentingTabsAreNamed) {
    EXPECT_TRUE(refused("patient:\n\tweight_kg: 3.5\n", {"baby.yaml:2", "tab", "spaces"}));
    EXPECT_TRUE(refused("patient:\n  weight_kg: 3.5\n \tjaw_opening_deg: 3\n", {"baby.yaml:3", "tab"}));
    EXPECT_TRUE(refused("patient:\n  weight_kg: 3.5\n\t# a remark\n", {"baby.yaml:3", "tab"}));
    // A tab separates words as a space does.
    EXPECT_EQ(scenario_refusal("patient:\n  weight_kg:\t3.5\n"), "");
}

TEST(Scenario, UnreadableOneIsShownWithDefaults) {
    EXPECT_FLOAT_EQ(shown_scenario("time_limit_s: 20\n").time_limit, 20);
    for (const char* text : {"", "a_key_of_tomorrow: 1\n", "time_limit_s: [\n"}) {
        EXPECT_EQ(shown_scenario(text).time_limit, Scenario().time_limit) << text;
    }
}

TEST(Scenario, OlderTissueMethodsAreReadAsImplicit) {
    EXPECT_EQ(read("physics: {tissue_method: tetrahedra}").physics.tissue_method, TissueMethod::implicit);
    EXPECT_EQ(read("physics: {tissue_method: clusters}").physics.tissue_method, TissueMethod::clusters);
    EXPECT_EQ(read("physics: {tissue_method: hexahedra}").physics.tissue_method, TissueMethod::implicit);
    EXPECT_TRUE(refused("physics: {tissue_method: cubes}", {"tissue_method", "clusters, implicit"}));
}

TEST(Scenario, ControlSequencesInNamesAreRefused) {
    for (const char* const key : {"name", "description"}) {
        for (const char* const text : {"\"\\e[31mred\"", "\"bell \\a\"", "\"a\\rb\"", "\"\\x9b31m\""}) {
            const std::string message = scenario_refusal(std::string(key) + ": " + text + "\n");
            EXPECT_NE(message.find(key), std::string::npos) << text << ": " << message;
            EXPECT_EQ(message.find_first_of("\x1b\a\r"), std::string::npos) << text;
        }
    }
    EXPECT_TRUE(refused("\"\\e[31m\": 1\n", {"unknown key '\\x1b[31m'"}));
    EXPECT_EQ(read("description: \"two\\nlines\"\n").description, "two\nlines");
}

TEST(Scenario, NumbersMustBeFiniteDecimals) {
    for (const char* typed :
         {".nan", ".inf", "-.inf", "1e400", "nan", "inf", "0x3", "3,5", "3 5", "''", "+", "1e"}) {
        EXPECT_TRUE(refused(std::string("patient: {weight_kg: ") + typed + "}\n", {"weight_kg"})) << typed;
    }
    EXPECT_FLOAT_EQ(read("patient: {weight_kg: 35e-1}\n").patient.shape.weight, 3.5f);
    EXPECT_FLOAT_EQ(read("patient: {weight_kg: 4.5}\n").patient.shape.weight, 4.5f)
        << "the ends belong to the range";
    EXPECT_FLOAT_EQ(read("patient: {weight_kg: 0.5}\n").patient.shape.weight, 0.5f);
}

TEST(Scenario, ShippedScenariosAreThePapersConditions) {
    const auto load = [](const char* name) { return load_scenario(find_data_file(name, "scenarios")); };
    const Scenario term = load("term"), premature = load("premature");
    EXPECT_EQ(term.blade, Blade::miller_1);
    EXPECT_FLOAT_EQ(term.tube.inner_diameter, 3.0e-3f);
    EXPECT_FALSE(term.saliva);
    EXPECT_EQ(premature.blade, Blade::miller_0);
    EXPECT_FLOAT_EQ(premature.tube.inner_diameter, 2.5e-3f);
    EXPECT_GT(premature.patient.shape.tongue_scale, term.patient.shape.tongue_scale);
    EXPECT_LT(premature.runtime_parameters.jaw_opening, term.runtime_parameters.jaw_opening);
    EXPECT_LT(premature.patient.shape.weight, term.patient.shape.weight);
    EXPECT_TRUE(premature.saliva);
    // Beside them, one that differs only in its liquid.
    const Scenario bleeding = load("premature_bleeding");
    EXPECT_EQ(bleeding.liquid, LiquidKind::blood);
    EXPECT_TRUE(bleeding.saliva);
    EXPECT_EQ(bleeding.patient.shape.weight, premature.patient.shape.weight);
    EXPECT_EQ(bleeding.patient.shape.tongue_scale, premature.patient.shape.tongue_scale);
    EXPECT_EQ(bleeding.runtime_parameters.jaw_opening, premature.runtime_parameters.jaw_opening);
    EXPECT_EQ(bleeding.runtime_parameters.head_elevation, premature.runtime_parameters.head_elevation);
    EXPECT_EQ(bleeding.tube.youngs_modulus, premature.tube.youngs_modulus);
    EXPECT_EQ(bleeding.seed, premature.seed);
    // The enhanced conditions differ only in what is shown.
    for (const auto& [plain, name] :
         {std::pair{term, "term_enhanced"}, std::pair{premature, "premature_enhanced"}}) {
        const Scenario enhanced = load(name);
        EXPECT_EQ(plain.runtime_parameters.view_enhanced, 0.0f);
        EXPECT_EQ(enhanced.runtime_parameters.view_enhanced, 1.0f);
        EXPECT_EQ(enhanced.name, name);
        EXPECT_EQ(enhanced.patient.shape.weight, plain.patient.shape.weight);
        EXPECT_EQ(enhanced.patient.shape.gestational_age, plain.patient.shape.gestational_age);
        EXPECT_EQ(enhanced.patient.shape.tongue_scale, plain.patient.shape.tongue_scale);
        EXPECT_EQ(enhanced.runtime_parameters.head_elevation, plain.runtime_parameters.head_elevation);
        EXPECT_EQ(enhanced.runtime_parameters.jaw_opening, plain.runtime_parameters.jaw_opening);
        EXPECT_EQ(enhanced.runtime_parameters.tissue_stiffness, plain.runtime_parameters.tissue_stiffness);
        EXPECT_EQ(enhanced.blade, plain.blade);
        EXPECT_EQ(enhanced.tube.inner_diameter, plain.tube.inner_diameter);
        EXPECT_EQ(enhanced.tube.length, plain.tube.length);
        EXPECT_EQ(enhanced.tube.youngs_modulus, plain.tube.youngs_modulus);
        EXPECT_EQ(enhanced.tube.grip_from_tip, plain.tube.grip_from_tip);
        EXPECT_EQ(enhanced.tube.curve_radius, plain.tube.curve_radius);
        EXPECT_EQ(enhanced.physics.substeps, plain.physics.substeps);
        EXPECT_EQ(enhanced.physics.spacing, plain.physics.spacing);
        EXPECT_EQ(enhanced.physics.fine_spacing, plain.physics.fine_spacing);
        EXPECT_EQ(enhanced.physics.region, plain.physics.region);
        EXPECT_EQ(enhanced.saliva, plain.saliva);
        EXPECT_EQ(enhanced.time_limit, plain.time_limit);
        EXPECT_EQ(enhanced.seed, plain.seed);
    }
}

}  // namespace
}  // namespace eti
