// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/window/hand_controls.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "client/app/window/command_keys.hpp"

namespace eti {
namespace {

TEST(HandControls, HelpListsEveryKeyOnce) {
    std::set<std::string> named;
    for (const auto& [key, help] : client::HandControls::help()) {
        EXPECT_TRUE(named.insert(key).second) << key;
        EXPECT_FALSE(help.empty()) << key;
    }
    for (const HandKey& row : hand_keys()) {
        EXPECT_TRUE(named.contains(std::string(row.caption))) << row.caption;
    }
    for (const client::Selection& row : client::selections()) {
        EXPECT_TRUE(named.contains(std::string(1, row.key))) << row.key;
    }
    for (const client::CommandKey& row : client::command_keys()) {
        EXPECT_TRUE(named.contains(std::string(row.caption))) << row.caption;
    }
    // Fits a window of 540 pixels, in three columns.
    EXPECT_LE(named.size(), 40u);
}

}  // namespace
}  // namespace eti
