// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "common/scenario/scenario.hpp"
#include "tests/support/scratch_folder.hpp"

namespace eti {
namespace {

namespace fs = std::filesystem;

class DataFile : public test::ScratchFolderTest {
  protected:
    DataFile() {
        fs::create_directories(folder / "scenarios");
        setenv("ETI_DATA", folder.c_str(), 1);
    }
    ~DataFile() override { unsetenv("ETI_DATA"); }

    fs::path write(const fs::path& name, const std::string& text) const {
        const fs::path file = folder / name;
        std::ofstream(file) << text;
        return file;
    }

    static std::string refusal(const std::string& name) {
        try {
            return "found " + find_data_file(name, "scenarios").string();
        } catch (const InputError& error) {
            return error.what();
        }
    }
};

TEST_F(DataFile, PathIsTakenAsGiven) {
    const fs::path file = write("baby.txt", "seed: 3\n");
    EXPECT_EQ(find_data_file(file.string(), "scenarios"), file);
    EXPECT_EQ(load_scenario(file).seed, 3u);
}

TEST_F(DataFile, UserFolderPrecedesShippedFiles) {
    EXPECT_EQ(fs::canonical(find_data_file("term", "scenarios")),
              fs::canonical(fs::path(ETI_SOURCE_DIR) / "deploy/data/scenarios/term.yaml"));
    const fs::path own = write("scenarios/term.yaml", "seed: 4\n");
    EXPECT_EQ(find_data_file("term", "scenarios"), own);
}

TEST_F(DataFile, UnknownNameListsFoldersAndCandidates) {
    write("scenarios/mine.yaml", "{}\n");
    const std::string message = refusal("nobody");
    for (const std::string& said :
         {std::string("nobody"), (folder / "scenarios").string(), std::string("mine"), std::string("term"),
          std::string("premature_enhanced")}) {
        EXPECT_NE(message.find(said), std::string::npos) << "no '" << said << "' in: " << message;
    }
}

TEST_F(DataFile, NamesCannotEscapeTheirFolder) {
    write("secret.yaml", "{}\n");
    for (const char* name : {"../secret", "..", ".", "", "/", "scenarios/../../secret"}) {
        EXPECT_EQ(refusal(name).rfind("found", 0), std::string::npos) << name;
    }
}

TEST_F(DataFile, NonRegularFileIsRefused) {
    for (const std::string& path :
         {folder.string(), std::string("/dev/zero"), (folder / "absent.yaml").string()}) {
        EXPECT_NE(refusal(path).find(path), std::string::npos);
        EXPECT_THROW((void)load_scenario(path), InputError) << path;
    }
}

TEST_F(DataFile, LargeFileIsRefusedUnread) {
    const fs::path file = write("large.yaml", "");
    fs::resize_file(file, 1ull << 40);  // sparse
    EXPECT_THROW((void)load_scenario(file), InputError);
}

}  // namespace
}  // namespace eti
