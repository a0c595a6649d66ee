// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/saliva_monitor.hpp"

#include <gmock/gmock.h>

namespace eti::app {
namespace {

using ::testing::HasSubstr;

TEST(SalivaMonitor, UsualSalivaGivesNoWarning) {
    SalivaMonitor watch;
    scene::SalivaState saliva;
    saliva.positions.resize(500);
    saliva.left = saliva.aspirated = 20;
    EXPECT_EQ(watch.check(saliva), "");
}

TEST(SalivaMonitor, WarnsOnceOfAFullMouth) {
    SalivaMonitor watch;
    scene::SalivaState saliva;
    saliva.positions.resize(500);
    saliva.overflow = 1;
    EXPECT_THAT(watch.check(saliva), HasSubstr("500 particles"));
    ++saliva.overflow;
    EXPECT_EQ(watch.check(saliva), "");
}

TEST(SalivaMonitor, WarnsOnceOfIgnoredNeighbours) {
    SalivaMonitor watch;
    scene::SalivaState saliva;
    saliva.overflow = 1;
    EXPECT_NE(watch.check(saliva), "");
    saliva.dropped_neighbours = 7;
    EXPECT_THAT(watch.check(saliva), HasSubstr("7 neighbours")) << "each finding has its own line";
    ++saliva.dropped_neighbours;
    EXPECT_EQ(watch.check(saliva), "");
}

}  // namespace
}  // namespace eti::app
