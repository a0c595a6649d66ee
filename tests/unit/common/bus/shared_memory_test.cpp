// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/shared_memory.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include <fstream>

#include "bus_fixture.hpp"

namespace eti::bus {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;

// Files whose lock a process holds open; other processes create and remove theirs meanwhile.
Options over_shared_memory(const std::string& name) {
    Options wanted = options(name);
    wanted.profile = std::filesystem::path(ETI_SOURCE_DIR) / "deploy/data/dds/shared_memory.xml";
    return wanted;
}

std::vector<std::string> transport_files_of(pid_t process) {
    std::vector<std::string> names;
    std::error_code closed;
    for (const auto& entry :
         std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/fd")) {
        const std::filesystem::path file = std::filesystem::read_symlink(entry.path(), closed);
        const std::string name = file.filename().string();
        if (!closed && file.parent_path() == "/dev/shm" && name.ends_with("_el") &&
            (name.starts_with("fastrtps_") || name.starts_with("fastdds_"))) {
            names.push_back(name.substr(0, name.size() - 3));
        }
    }
    return names;
}

TEST(SharedMemory, FilesOfRunningNodeAreNotStale) {
    const Node node(over_shared_memory("living"));
    const auto made = transport_files_of(::getpid());
    ASSERT_THAT(made, Not(IsEmpty())) << "the node made no shared memory; what is tested here?";
    for (const auto& name : find_stale_shared_memory().transport) {
        EXPECT_THAT(made, Not(Contains(name)));
    }
}

// A real case: a killed process leaves its files behind.
TEST(SharedMemory, FilesOfKilledNodeAreStale) {
    int ready[2];
    ASSERT_EQ(::pipe(ready), 0);
    const pid_t child = ::fork();
    if (child == 0) {
        const Node node(over_shared_memory("killed"));
        char byte = 1;
        (void)!::write(ready[1], &byte, 1);
        ::pause();
        ::_exit(0);
    }
    char byte = 0;
    ASSERT_EQ(::read(ready[0], &byte, 1), 1);
    const auto made = transport_files_of(child);
    ASSERT_EQ(::kill(child, SIGKILL), 0);
    ASSERT_EQ(::waitpid(child, nullptr, 0), child);
    ::close(ready[0]);
    ::close(ready[1]);
    ASSERT_THAT(made, Not(IsEmpty()));
    EXPECT_THAT(find_stale_shared_memory().transport, IsSupersetOf(made));
    for (const auto& name : made) {
        std::filesystem::remove("/dev/shm/" + name);
        std::filesystem::remove("/dev/shm/" + name + "_el");
        std::filesystem::remove("/dev/shm/sem." + name + "_mutex");
    }
}

TEST(SharedMemory, DataSharingFilesAreStaleUnlessMapped) {
    const auto folder = std::filesystem::temp_directory_path() / ("eti_shm_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    for (const char* name : {"fast_datasharing_dead", "fast_datasharing_used", "someone_elses"}) {
        std::ofstream(folder / name) << std::string(4096, 'x');
    }
    const int used = ::open((folder / "fast_datasharing_used").c_str(), O_RDWR);
    void* memory = ::mmap(nullptr, 4096, PROT_READ, MAP_SHARED, used, 0);
    ASSERT_NE(memory, MAP_FAILED);
    EXPECT_THAT(find_stale_shared_memory(folder).data_sharing, ElementsAre("fast_datasharing_dead"));
    EXPECT_THAT(find_stale_shared_memory(folder).transport, IsEmpty());
    ::munmap(memory, 4096);
    ::close(used);
    std::filesystem::remove_all(folder);
    EXPECT_THAT(find_stale_shared_memory(folder).data_sharing, IsEmpty()) << "a missing folder is no error";
}

}  // namespace
}  // namespace eti::bus
