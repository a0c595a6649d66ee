// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/files/descriptor.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <utility>

namespace {

using eti::Descriptor;

int open_null() {
    return ::open("/dev/null", O_RDONLY | O_CLOEXEC);
}

/// By the kernel (fcntl(2)): a number that is not open gives EBADF.
bool is_open(int id) {
    return ::fcntl(id, F_GETFD) != -1 || errno != EBADF;
}

TEST(Descriptor, IsClosedWithItsOwner) {
    int id = -1;
    {
        const Descriptor file(open_null());
        id = file.get();
        ASSERT_TRUE(file);
        EXPECT_TRUE(is_open(id));
    }
    EXPECT_FALSE(is_open(id));
}

TEST(Descriptor, IsClosedOnce) {
    Descriptor file(open_null());
    const int id = file.get();
    file.close();
    EXPECT_FALSE(file);
    const Descriptor next(open_null());  // the kernel assigns the lowest free number: the same again
    ASSERT_EQ(next.get(), id);
    file.close();
    EXPECT_TRUE(is_open(id));
}

TEST(Descriptor, MoveTransfersOwnership) {
    Descriptor first(open_null());
    const int id = first.get();
    Descriptor second(std::move(first));
    EXPECT_EQ(second.get(), id);
    EXPECT_FALSE(first);  // NOLINT(bugprone-use-after-move): says that it owns nothing
    const int replaced = second.get();
    second = Descriptor(::open("/dev/zero", O_RDONLY | O_CLOEXEC));
    EXPECT_FALSE(is_open(replaced));
    EXPECT_TRUE(is_open(second.get()));
}

TEST(Descriptor, FailedOpenIsEmpty) {
    const Descriptor none(::open("/dev/null/none", O_RDONLY | O_CLOEXEC));
    EXPECT_FALSE(none);
    EXPECT_FALSE(Descriptor());
}

}  // namespace
