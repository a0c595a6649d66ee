// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/output/session_info.hpp"

#include <gmock/gmock.h>

#include "tests/support/coarse_newborn.hpp"

namespace eti::app {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(SessionInfo, SamePatientHasNoDifferences) {
    const patient::Patient patient = test::coarse_newborn();
    EXPECT_THAT(differences(session_info(Scenario{}, patient), session_info(Scenario{}, patient)), IsEmpty());
}

TEST(SessionInfo, DifferencesNameEveryReproducibilityInput) {
    patient::Patient patient = test::coarse_newborn();
    const session::SessionInfo here = session_info(Scenario{}, patient);
    patient.particles.rest[7].x() += 1e-6f;
    session::SessionInfo recorded = session_info(Scenario{}, patient);
    EXPECT_THAT(differences(recorded, here), ElementsAre(HasSubstr("patient")));
    recorded.version = "0.0.1";
    recorded.build = "compiler 1";
    recorded.more[processor_text] = "another";
    recorded.more[libraries_text] = "Bullet 2";
    recorded.more[physics_text] = "01234567";
    EXPECT_THAT(differences(recorded, here),
                ElementsAre(AllOf(HasSubstr("version"), HasSubstr("0.0.1 in the recording")),
                            HasSubstr("compiler 1"), AllOf(HasSubstr("processor"), HasSubstr("another in")),
                            HasSubstr("Bullet 2"), HasSubstr("01234567 in"), HasSubstr("patient")));
}

TEST(SessionInfo, OlderFilesAreOfAnEarlierPhysics) {
    const patient::Patient patient = test::coarse_newborn();
    session::SessionInfo recorded = session_info(Scenario{}, patient);
    recorded.more.clear();
    EXPECT_THAT(differences(recorded, session_info(Scenario{}, patient)),
                ElementsAre(HasSubstr("physics: an earlier version in the recording")));
}

}  // namespace
}  // namespace eti::app
