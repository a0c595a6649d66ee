// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/force_limit_monitor.hpp"

#include <gmock/gmock.h>

namespace eti::app {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A blade `apart` [m] from the hand that holds it, pressed with `force` [N] against the upper gum.
scene::Snapshot pressed(float apart, float force) {
    scene::Snapshot snapshot;
    snapshot.time_ns = 2'500'000'000;
    snapshot.device.translation = {0.0f, apart, 0.0f};
    snapshot.shell_contacts.push_back({.force = force, .tissue = Tissue::upper_gum});
    return snapshot;
}

TEST(ForceLimitMonitor, NormalHandMotionGivesNoWarning) {
    ForceLimitMonitor watch;
    EXPECT_EQ(watch.check({}, "lift"), "");
    EXPECT_EQ(watch.check(pressed(9.9e-3f, 49.9f), "lift"), "");
    scene::Snapshot free = pressed(30e-3f, 0.0f);
    free.shell_contacts.clear();
    EXPECT_EQ(watch.check(free, "lift"), "") << "a fast hand touches nothing";
    scene::Snapshot chin = pressed(0.0f, 60.0f);
    chin.shell_contacts.front().tissue = Tissue::lower_gum;
    EXPECT_EQ(watch.check(chin, "lift"), "") << "the limit is the upper gum's";
}

TEST(ForceLimitMonitor, WarnsOnceWhenHandOutrunsBlade) {
    ForceLimitMonitor watch;
    scene::Snapshot between = pressed(12.5e-3f, 31.0f);
    between.shell_contacts.push_back({.force = 35.0f, .tissue = Tissue::lower_gum});
    EXPECT_THAT(
        watch.check(between, "withdraw"),
        AllOf(HasSubstr("at 2.5 s, in stage 'withdraw'"), HasSubstr("is 12 mm from"),
              HasSubstr("(lower gum, 35 N)"), HasSubstr("at most 10 mm"), HasSubstr("earlier stages")));
    EXPECT_EQ(watch.check(pressed(20e-3f, 31.0f), "withdraw"), "");
}

TEST(ForceLimitMonitor, WarnsOnceAboutExcessiveGumForce) {
    ForceLimitMonitor watch;
    // Of two contacts and a particle, 30 + 20 + 4 N.
    scene::Snapshot both = pressed(0.0f, 30.0f);
    both.shell_contacts.push_back({.force = 20.0f, .tissue = Tissue::upper_gum});
    both.shell_contacts.push_back({.force = 48.0f, .tissue = Tissue::lower_gum});
    both.tissue_contacts.push_back({.force = {0.0f, 4.0f, 0.0f}, .tissue = Tissue::upper_gum});
    EXPECT_THAT(watch.check(both, ""),
                AllOf(HasSubstr("at 2.5 s the force is 54 N on the upper gum and 48 N on the lower gum"),
                      HasSubstr("at most 50 N"), Not(HasSubstr("stage"))));
    EXPECT_EQ(watch.check(both, ""), "");
    EXPECT_THAT(watch.check(pressed(20e-3f, 80.0f), ""), HasSubstr("is 20 mm from")) << "still new";
}

}  // namespace
}  // namespace eti::app
