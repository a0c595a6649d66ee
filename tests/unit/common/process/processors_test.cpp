// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/threads/processors.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <fstream>
#include <thread>

namespace eti {
namespace {

/// A tree of control groups, as a kernel shows it.
class ProcessorQuota : public ::testing::Test {
  protected:
    ProcessorQuota() {
        root_ = std::filesystem::temp_directory_path() / ("eti_cgroup_" + std::to_string(::getpid()));
    }
    ~ProcessorQuota() override { std::filesystem::remove_all(root_); }
    void write(const std::filesystem::path& file, const std::string& text) const {
        std::filesystem::create_directories((root_ / file).parent_path());
        std::ofstream(root_ / file) << text << '\n';
    }
    std::filesystem::path root_;
};

TEST_F(ProcessorQuota, IsAbsentWithoutLimits) {
    EXPECT_FALSE(processor_quota("0::/user.slice\n", root_));
    write("cpu.max", "max 100000");
    write("user.slice/cpu.max", "max 100000");
    EXPECT_FALSE(processor_quota("0::/user.slice\n", root_));
    EXPECT_FALSE(processor_quota("", root_));
    EXPECT_FALSE(processor_quota("no such format", root_));
}

TEST_F(ProcessorQuota, Version2TakesTheSmallestUpToTheRoot) {
    write("pod/cpu.max", "300000 100000");
    write("pod/container/cpu.max", "max 100000");
    EXPECT_EQ(processor_quota("0::/pod/container\n", root_), 3.0);
    write("pod/container/cpu.max", "75000 50000");
    EXPECT_EQ(processor_quota("0::/pod/container\n", root_), 1.5);
    EXPECT_EQ(processor_quota("0::/pod\n", root_), 3.0);
}

// docker run --cpus 2, seen from inside: the group is the root.
TEST_F(ProcessorQuota, ContainerRootIsItsGroup) {
    write("cpu.max", "200000 100000");
    EXPECT_EQ(processor_quota("0::/\n", root_), 2.0);
    EXPECT_EQ(processor_quota("0::/docker/0123\n", root_), 2.0) << "the host's path is not visible";
}

TEST_F(ProcessorQuota, Version1HasQuotaAndPeriod) {
    write("cpu,cpuacct/docker/0123/cpu.cfs_quota_us", "-1");
    write("cpu,cpuacct/docker/0123/cpu.cfs_period_us", "100000");
    const std::string groups = "12:memory:/docker/0123\n4:cpu,cpuacct:/docker/0123\n1:cpuset:/\n";
    EXPECT_FALSE(processor_quota(groups, root_));
    write("cpu,cpuacct/docker/0123/cpu.cfs_quota_us", "250000");
    EXPECT_EQ(processor_quota(groups, root_), 2.5);
}

TEST(UsableProcessors, RespectsAffinity) {
    std::thread([] {
        cpu_set_t before;
        ASSERT_EQ(::sched_getaffinity(0, sizeof before, &before), 0);
        EXPECT_LE(usable_processors(), static_cast<unsigned>(CPU_COUNT(&before)));
        cpu_set_t one;
        CPU_ZERO(&one);
        for (int processor = 0; processor < CPU_SETSIZE; ++processor) {
            if (CPU_ISSET(processor, &before)) {
                CPU_SET(processor, &one);
                break;
            }
        }
        ASSERT_EQ(::sched_setaffinity(0, sizeof one, &one), 0);
        EXPECT_EQ(usable_processors(), 1u);
    }).join();
}

}  // namespace
}  // namespace eti
