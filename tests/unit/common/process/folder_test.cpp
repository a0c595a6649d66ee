// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/folder.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace {

namespace fs = std::filesystem;

class MakeFolder : public ::testing::Test {
  protected:
    void SetUp() override {
        char name[] = "/tmp/eti-folder-XXXXXX";
        ASSERT_NE(::mkdtemp(name), nullptr);
        place_ = name;
    }
    void TearDown() override { fs::remove_all(place_); }

    fs::path place_;
};

TEST_F(MakeFolder, MakesThoseAboveItToo) {
    eti::make_folder(place_ / "a/b/c");
    EXPECT_TRUE(fs::is_directory(place_ / "a/b/c"));
    eti::make_folder(place_ / "a/b/c");  // is there already
}

TEST_F(MakeFolder, NamesPlaceCauseAndRemedyWhereAFileIsInTheWay) {
    const fs::path file = place_ / "file";
    std::ofstream(file) << "kept";
    for (const fs::path& folder : {file, file / "below"}) {
        try {
            eti::make_folder(folder, "--golden");
            ADD_FAILURE() << folder;
        } catch (const std::runtime_error& error) {
            EXPECT_EQ(error.what(),
                      folder.string() +
                          ": the folder cannot be made: Not a directory; choose another with --golden");
        }
    }
    EXPECT_TRUE(fs::is_regular_file(file));
}

}  // namespace
