// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/files/folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "tests/support/error_of.hpp"
#include "tests/support/scratch_folder.hpp"

namespace {

namespace fs = std::filesystem;

class MakeFolder : public eti::test::ScratchFolderTest {};

TEST_F(MakeFolder, MakesParentFolders) {
    eti::make_folder(folder / "a/b/c");
    EXPECT_TRUE(fs::is_directory(folder / "a/b/c"));
    eti::make_folder(folder / "a/b/c");  // exists already
}

TEST_F(MakeFolder, BlockingFileErrorNamesCauseAndRemedy) {
    const fs::path file = folder / "file";
    std::ofstream(file) << "kept";
    for (const fs::path& folder : {file, file / "below"}) {
        EXPECT_EQ(
            eti::test::error_of<std::runtime_error>([&] { eti::make_folder(folder, "--golden"); }),
            folder.string() + ": cannot create the folder: Not a directory; choose another with --golden");
    }
    EXPECT_TRUE(fs::is_regular_file(file));
}

}  // namespace
