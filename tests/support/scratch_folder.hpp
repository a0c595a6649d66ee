// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace eti::test {

/// A test fixture with an empty folder of its own.
class ScratchFolder : public ::testing::Test {
  protected:
    void SetUp() override {
        char name[] = "/tmp/eti-scratch-XXXXXX";
        ASSERT_NE(::mkdtemp(name), nullptr);
        folder_ = name;
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path folder_;
};

}  // namespace eti::test
