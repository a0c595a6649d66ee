// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <spdlog/spdlog.h>

#include "common/bus/codec/convert.hpp"
#include "common/process/threads/priority.hpp"
#include "devices/app/program.hpp"
#include "devices/app/sampling.hpp"
#include "devices/haptics/haptic_loop.hpp"

namespace eti::devices {
namespace {

constexpr std::int64_t period_ns = 1'000'000'000 / 240;
constexpr std::uint64_t cycles_per_report = 48;  // five times a second

/// Publishes the tube's pose at 240 Hz until there is a reason to end.
class TubeTracker {
  public:
    TubeTracker(Program& program, SensorMonitor& watch)
        : program_(program), watch_(watch), topic_(program.node(), bus::topics::tube_pose) {}

    void run() {
        std::int64_t last = monotonic_ns(), next = last;
        while (!program_.should_end()) {
            sleep_until_ns(next);
            const std::int64_t now = monotonic_ns();
            if (now < next) {
                continue;
            }
            watch_.poll_events();
            cycle(now, static_cast<float>(now - last) * 1e-9f);
            if (++cycles_ % cycles_per_report == 0) {
                program_.report(watch_);
            }
            program_.alive();
            intervals_.record(now - last);
            last = now;
            next += period_ns * (1 + (now - next) / period_ns);
        }
    }

    [[nodiscard]] nlohmann::ordered_json statistics() const {
        return {{"cycles", intervals_.count()},
                {"cycle_ms",
                 {{"p50", 1e3 * intervals_.percentile(0.5)},
                  {"p99", 1e3 * intervals_.percentile(0.99)},
                  {"max", 1e3 * intervals_.longest()}}},
                {"poses_published", published_}};
    }

  private:
    /// A device with its own servo thread is read only there. A tracked tube has no motors.
    [[nodiscard]] Reading read(float elapsed) {
        if (!servo_.on_servo()) {
            return watch_.exchange({}, elapsed);
        }
        Reading reading;
        const bool fresh = servo_.newest(reading);
        reading.present = fresh;
        return reading;
    }

    void cycle(std::int64_t now, float elapsed) {
        const SceneState* scene = nullptr;
        (void)program_.link().newest().read(scene);
        double time = 0.0;
        if (scene->proxy_arrived != 0) {
            Observation seen = scene->seen;
            seen.time = time = time_.at(*scene, now);
            watch_.observe(seen);
        }
        const Reading reading = read(elapsed);
        if (!reading.present) {
            return;
        }
        message_.header(
            bus::make_header(static_cast<std::uint64_t>(time * 1e9), static_cast<std::uint32_t>(published_)));
        message_.pose(bus::to_msg(reading.motion.pose));
        message_.buttons(reading.buttons);
        published_ += topic_.publish(message_) ? 1 : 0;
    }

    Program& program_;
    SensorMonitor& watch_;
    bus::Publisher<msg::ToolPose> topic_;
    msg::ToolPose message_;
    SimulationTime time_;
    CycleStatistics intervals_;
    ServoReading servo_{watch_};
    std::uint64_t published_ = 0;
    std::uint64_t cycles_ = 0;
};

int run(const ProgramOptions& options) {
    // This loop and the bus's threads are part of the haptic path. With a lower priority than the server's
    // steps, on a core kept busy by other work, they would be silent for half a second.
    const RealTimeThreads real_time(priority::bus);
    if (!real_time.refusal().empty()) {
        spdlog::warn("{}", real_time.refusal());
    }
    Program program(options, Tool::tube);
    program.run([&](SensorMonitor& watch) {
        TubeTracker tracker(program, watch);
        tracker.run();
        return tracker.statistics();
    });
    return 0;
}

}  // namespace
}  // namespace eti::devices

int main(int argc, char** argv) {
    using namespace eti::devices;
    ProgramOptions options;
    options.bus.name = "eti-tracker";
    eti::CommandLine app("The tube's tracker: sends the pose of the tube's grip to the server at 240 Hz.",
                         "eti-tracker");
    add_options(app, options);
    return eti::run_program(
        app, argc, argv, [&] { return run(options); }, device_signals);
}
