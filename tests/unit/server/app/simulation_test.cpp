// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/simulation.hpp"

#include <gmock/gmock.h>

#include "tests/support/coarse_newborn.hpp"

namespace eti::app {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Scenario stiff(float modulus, int substeps, TissueMethod model) {
    Scenario scenario;
    scenario.name = "stiff";
    scenario.runtime_parameters.tissue_stiffness = modulus;
    scenario.physics.substeps = substeps;
    scenario.physics.tissue_method = model;
    return scenario;
}

std::string refusal_of(const Scenario& scenario) {
    patient::Patient patient = test::coarse_newborn();
    patient.tissue_stiffness = scenario.runtime_parameters.tissue_stiffness;
    try {
        const Simulation simulation(scenario, patient, parked_inputs(scenario, patient));
    } catch (const InputError& error) {
        return error.what();
    }
    return "none";
}

TEST(Simulation, RefusesStiffnessAboveStabilityLimit) {
    // 0.8 * 4000 kg/m^3 * (3.5 mm * 720 / s)^2 = 20.3 kPa.
    EXPECT_THAT(refusal_of(stiff(21e3f, 4, TissueMethod::tetrahedra)),
                AllOf(HasSubstr("'stiff'"), HasSubstr("tissue_stiffness_kpa is 21"),
                      HasSubstr("at most 20.3"), HasSubstr("physics.substeps to 5"), HasSubstr("implicit")));
    EXPECT_EQ(refusal_of(stiff(20e3f, 4, TissueMethod::tetrahedra)), "none");
    EXPECT_EQ(refusal_of(stiff(21e3f, 5, TissueMethod::tetrahedra)), "none");
    EXPECT_EQ(refusal_of(stiff(21e3f, 4, TissueMethod::clusters)), "none");
    EXPECT_EQ(refusal_of(stiff(100e3f, 1, TissueMethod::implicit)), "none");
}

}  // namespace
}  // namespace eti::app
