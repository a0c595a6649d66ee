// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/files/atomic_file_writer.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <iterator>

#include "tests/support/scratch_folder.hpp"

namespace eti {
namespace {

namespace fs = std::filesystem;

class AtomicFileWriterTest : public test::ScratchFolderTest {
  protected:
    static std::string text_of(const fs::path& file) {
        std::ifstream in(file);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    [[nodiscard]] std::ptrdiff_t entries() const {
        return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
    }
};

TEST_F(AtomicFileWriterTest, FinishedFileReplacesTheOldOne) {
    const fs::path name = folder / "a";
    std::ofstream(name) << "old";
    {
        AtomicFileWriter file(name);
        std::ofstream(file.path()) << "new";
        EXPECT_EQ(text_of(name), "old");
        file.finish();
    }
    EXPECT_EQ(text_of(name), "new");
    EXPECT_EQ(entries(), 1);
}

TEST_F(AtomicFileWriterTest, UnfinishedWriteKeepsTheOldFile) {
    const fs::path name = folder / "a";
    std::ofstream(name) << "old";
    {
        const AtomicFileWriter file(name);
        std::ofstream(file.path()) << "new";
    }
    EXPECT_EQ(text_of(name), "old");
    EXPECT_EQ(entries(), 1);
}

TEST_F(AtomicFileWriterTest, WritesWholeFileOrReportsError) {
    EXPECT_EQ(write_file_atomically(folder / "a", std::string("1\0 2", 4)), "");
    EXPECT_EQ(text_of(folder / "a"), std::string("1\0 2", 4));
    EXPECT_EQ(write_file_atomically(folder / "none" / "a", "x"), "No such file or directory");
    EXPECT_EQ(write_file_atomically(folder, "x"), "is a folder");
    const fs::path pipe = folder / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_EQ(write_file_atomically(pipe, "x"), "is a pipe");
    EXPECT_TRUE(fs::is_fifo(pipe));
    EXPECT_EQ(entries(), 2);
}

}  // namespace
}  // namespace eti
