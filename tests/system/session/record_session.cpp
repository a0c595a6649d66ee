// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// Records a synthetic session, for tests that kill it or remove its disk.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <thread>

#include "common/hdf5/handle.hpp"
#include "common/session/writer.hpp"
#include "tests/unit/common/session/sample.hpp"

using namespace eti::session;
using Clock = std::chrono::steady_clock;

namespace {

/// Push time of each step [ns of the monotonic clock], in a file that outlives the process.
class Log {
  public:
    Log(const char* path, std::size_t steps) {
        const int file = ::open(path, O_RDWR | O_CREAT | O_TRUNC, 0644);
        if (file < 0 || ::ftruncate(file, static_cast<off_t>(steps * sizeof(std::int64_t))) != 0) {
            std::perror(path);
            std::exit(1);
        }
        void* const place =
            ::mmap(nullptr, steps * sizeof(std::int64_t), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
        if (place == MAP_FAILED) {
            std::perror(path);
            std::exit(1);
        }
        times_ = static_cast<std::int64_t*>(place);
        ::close(file);
    }
    void pushed(std::uint64_t step) {
        times_[step] =
            std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
    }

  private:
    std::int64_t* times_ = nullptr;
};

}  // namespace

int main(int argc, char** argv) {
    if (argc != 5) {
        std::cerr << "usage: record_session FILE LOG STEPS SPEED   (SPEED: times real time; 0: as fast as "
                     "possible)\n";
        return 2;
    }
    const std::uint64_t steps = std::strtoull(argv[3], nullptr, 10);
    const double speed = std::strtod(argv[4], nullptr);
    SessionWriter::Settings settings;
    settings.on_error = [](const std::string& text) { std::cerr << text << std::endl; };
    settings.on_warning = settings.on_error;
    settings.wait_when_full = speed == 0.0;
    // As long as in real time, for a machine under other load.
    settings.waiting_steps =
        static_cast<std::size_t>(static_cast<double>(settings.waiting_steps) * std::max(speed, 1.0));
    Log log(argv[2], steps);
    try {
        SessionWriter writer(argv[1], sample::info(), sample::scene(3000), settings);
        std::cout << "recording" << std::endl;
        const Clock::time_point start = Clock::now();
        for (std::uint64_t i = 0; i < steps; ++i) {
            if (speed > 0.0) {
                std::this_thread::sleep_until(start + std::chrono::nanoseconds(static_cast<std::int64_t>(
                                                          static_cast<double>(i * sample::step_ns) / speed)));
            }
            if (i % 12 == 0) {
                writer.push(sample::deformation(i));
            }
            if (i % 90 == 0) {
                writer.push(sample::event(i));
            }
            if (i % 180 == 0) {
                writer.push(sample::state(i));
            }
            writer.push(sample::step(i));
            log.pushed(i);
        }
        eti::Outcome outcome;
        outcome.success = true;
        outcome.reason = "made up";
        writer.push(SummaryRecord{1, outcome, sample::step(steps).metrics});
        writer.push(SummaryRecord{0, outcome, sample::step(steps).metrics});
        return writer.close() ? 0 : 3;
    } catch (const eti::hdf5::Error& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
