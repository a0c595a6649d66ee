// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/parallel/worker_start.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>
#include <vector>

#include "server/parallel/loops.hpp"
#include "tests/support/threads.hpp"

namespace eti::parallel {
namespace {

TEST(WorkerStart, IsCalledOncePerWorkerThread) {
    std::mutex mutex;
    std::vector<std::thread::id> started, helped;
    const std::thread::id caller = std::this_thread::get_id();
    test::with_threads(2, [&] {
        const WorkerStart start([&] {
            const std::scoped_lock lock(mutex);
            started.push_back(std::this_thread::get_id());
        });
        for (int round = 0; round < 3; ++round) {
            // Each half waits for the other, so that two threads are required.
            std::atomic<int> there = 0;
            for_each(2, 1, [&](int) {
                ++there;
                while (there < 2) {
                    std::this_thread::yield();
                }
                const std::scoped_lock lock(mutex);
                if (std::this_thread::get_id() != caller) {
                    helped.push_back(std::this_thread::get_id());
                    EXPECT_EQ(std::ranges::count(started, helped.back()), 1);
                }
            });
        }
        return 0;
    });
    EXPECT_EQ(helped.size(), 3u);
    EXPECT_EQ(std::ranges::count(started, caller), 0);
}

}  // namespace
}  // namespace eti::parallel
