// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/devices/live.hpp"

#include <algorithm>
#include <deque>
#include <memory>
#include <optional>
#include <thread>
#include <tuple>
#include <vector>

#include "common/bus/codec/convert.hpp"
#include "common/process/threads/priority.hpp"
#include "devices/haptics/haptic_loop.hpp"
#include "devices/haptics/scene_link.hpp"
#include "devices/sensor/hand_sensor.hpp"
#include "tests/bench/devices/relay.hpp"
#include "tests/bench/devices/server_process.hpp"

namespace eti::bench {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr double held_for = 2.0;  // [s], at the end, over which the held device is observed

// Moves in, levers on the gum until the force is felt, and stays.
constexpr const char* lever = R"(
name: lever_and_hold
laryngoscope:
  - stage: to the mouth
    tip: {at: mouth_opening, offset_mm: [0, -6, 2]}
    axis: {from: mouth_opening, from_offset_mm: [0, -60, 10]}
    speed_mm_per_s: 80
  - stage: between the gums
    tip: {at: upper_gum, offset_mm: [0, 3, -8]}
    axis: {from: upper_gum, from_offset_mm: [0, -30, -8]}
    speed_mm_per_s: 60
  - stage: over the tongue
    tip: {at: tongue_dorsum, offset_mm: [0, 0, 4]}
    axis: {from: upper_gum, from_offset_mm: [0, -7, -7]}
    speed_mm_per_s: 50
  - stage: behind the tongue
    tip: {at: tongue_dorsum, offset_mm: [0, 11, -9]}
    axis: {from: upper_gum, from_offset_mm: [0, -7, -6]}
    speed_mm_per_s: 40
  - stage: down behind the epiglottis
    tip: {at: glottis, offset_mm: [0, -3, 30]}
    axis: {from: upper_gum, from_offset_mm: [0, -6, -6]}
    speed_mm_per_s: 40
  - stage: beneath the epiglottis
    tip: {at: glottis, offset_mm: [0, -4, 9]}
    axis: {from: upper_gum, from_offset_mm: [0, -6, -6]}
    speed_mm_per_s: 30
  - stage: lever on the gum and hold
    keep: on
    pitch_deg: 8
    speed_mm_per_s: 40
    hold_s: 119
)";

LoopTiming timing_of(const devices::CycleStatistics& intervals) {
    LoopTiming timing;
    timing.period_p50 = intervals.percentile(0.5);
    timing.period_p99 = intervals.percentile(0.99);
    timing.period_p999 = intervals.percentile(0.999);
    timing.period_max = intervals.longest();
    timing.late_share = intervals.share_over(1.2e-3);
    return timing;
}

/// Records the hand's motion for the end.
class Watched final : public devices::Sensor {
  public:
    explicit Watched(const devices::SensorSetup& setup) : hand_(setup) {}
    void observe(const Observation& seen) override { hand_.observe(seen); }
    devices::Reading exchange(const Wrench& wrench, float elapsed) override {
        const devices::Reading reading = hand_.exchange(wrench, elapsed);
        places_[at_ % places_.size()] = {reading.motion.pose.translation, wrench.force.norm()};
        ++at_;
        return reading;
    }
    [[nodiscard]] devices::DeviceCapabilities capabilities() const override { return hand_.capabilities(); }

    struct Place {
        Vec3f position = Vec3f::Zero();
        float force = 0.0f;
    };
    /// Peak to peak [m] over the whole observation, the same in its stillest fifth of a second (exceeded by a
    /// limit cycle), and the mean force [N].
    [[nodiscard]] std::tuple<double, double, double> held() const {
        constexpr std::size_t window = 200;  // cycles
        Eigen::AlignedBox3f whole, part;
        double force = 0.0, min_excursion = 1.0;
        const std::size_t count = std::min(at_, places_.size());
        for (std::size_t i = 0; i < count; ++i) {
            const Place& place = places_[(at_ - count + i) % places_.size()];
            whole.extend(place.position);
            part.extend(place.position);
            force += static_cast<double>(place.force) / static_cast<double>(count);
            if (i % window == window - 1) {
                min_excursion = std::min(min_excursion, static_cast<double>(part.diagonal().norm()));
                part.setEmpty();
            }
        }
        return {count > 0 ? static_cast<double>(whole.diagonal().norm()) : 0.0, min_excursion, force};
    }

  private:
    devices::HandSensor hand_;
    std::array<Place, static_cast<std::size_t>(1000 * held_for)> places_{};
    std::size_t at_ = 0;
};

/// Time from sending a pose, by its sender's clock, to the proxy that answers it, matched by the device pose
/// that the server reports.
class RoundTrips {
  public:
    explicit RoundTrips(bus::Node& node)
        : poses_(node, bus::topics::laryngoscope_pose), proxies_(node, bus::topics::proxy) {}

    void watch() {
        (void)proxies_.wait(2ms);
        const auto now = static_cast<std::int64_t>(bus::wall_clock_ns());
        while (poses_.take(pose_)) {
            sent_.push_back({bus::from_msg(pose_.pose()).translation,
                             static_cast<std::int64_t>(pose_.header().send_time_ns())});
            if (sent_.size() > 2000) {
                sent_.pop_front();
            }
        }
        while (proxies_.take(proxy_)) {
            const Vec3f at = bus::from_msg(proxy_.device()).translation;
            const auto found =
                std::find_if(sent_.rbegin(), sent_.rend(), [&](const auto& s) { return s.first == at; });
            // A hand at rest sends the same pose repeatedly, which identifies nothing.
            if (found != sent_.rend() && at != last_) {
                trips_.push_back(static_cast<double>(now - found->second) * 1e-9);
            }
            last_ = at;
        }
    }
    [[nodiscard]] double percentile(double p) {
        std::ranges::sort(trips_);
        return trips_.empty() ? 0.0
                              : trips_[static_cast<std::size_t>(p * static_cast<double>(trips_.size() - 1))];
    }

  private:
    bus::Subscriber<msg::ToolPose> poses_;
    bus::Subscriber<msg::ProxyState> proxies_;
    msg::ToolPose pose_;
    msg::ProxyState proxy_;
    std::deque<std::pair<Vec3f, std::int64_t>> sent_;
    Vec3f last_ = Vec3f::Zero();
    std::vector<double> trips_;
};

LoopTiming timing_of(const devices::HapticLoop& loop) {
    const devices::HapticRecord& record = loop.cycle().record();
    LoopTiming timing = timing_of(record.intervals);
    timing.compute_p99 = record.computing.percentile(0.99);
    timing.real_time = loop.priority_refusal().empty();
    return timing;
}

}  // namespace

LoopTiming run_empty_loop(double seconds, bool beside_a_server) {
    std::optional<ServerProcess> server;
    if (beside_a_server) {
        const std::string session = "bench-" + std::to_string(::getpid());
        server.emplace("term", session, bench_domain());
        bus::Node node(place(session, bench_domain(), "listener"));
        const devices::SceneLink link(node, devices::SceneLink::ForceSource::tissue);
        (void)server->scene(link);
    }
    devices::CycleStatistics intervals;
    bool real_time = false;
    std::thread([&] {
        real_time = set_real_time_priority(priority::loop).empty();
        std::int64_t last = devices::monotonic_ns(), next = last;
        const std::int64_t end = last + static_cast<std::int64_t>(1e9 * seconds);
        while (last < end) {
            next += 1'000'000 * (1 + std::max<std::int64_t>(0, last - next) / 1'000'000);
            devices::sleep_until_ns(next);
            const std::int64_t now = devices::monotonic_ns();
            intervals.record(now - last);
            last = now;
        }
    }).join();
    LoopTiming timing = timing_of(intervals);
    timing.real_time = real_time;
    return timing;
}

LoopTiming run_loop_alone(double seconds) {
    bus::Node node(place("bench-" + std::to_string(::getpid()), bench_domain(), "eti-haptics"));
    devices::SceneLink link(node, devices::SceneLink::ForceSource::tissue);
    devices::HandSensor sensor(devices::SensorSetup{});
    devices::HapticLoop loop(node, sensor, link.newest(), {});
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    loop.stop();
    return timing_of(loop);
}

LiveOutcome run_live(const LiveCase& live) {
    const int domain = bench_domain();
    const std::string there = "bench-" + std::to_string(::getpid());
    const std::string here = live.channel ? there + "-far" : there;
    const ServerProcess server("term", there, domain);
    std::unique_ptr<Relay> relay;
    if (live.channel) {
        relay = std::make_unique<Relay>(place(there, domain, "relay"),
                                        place(here, domain, bus::server_name.data()), *live.channel);
    }
    // Same thread priorities as eti-haptics; otherwise the round trips would include a listener's scheduling
    // delay.
    const RealTimeThreads real_time(priority::bus);
    bus::Node node(place(here, domain, "eti-haptics"));
    devices::SceneLink link(node, devices::SceneLink::ForceSource::tissue);
    const devices::InitialScene around = server.scene(link);
    devices::SensorSetup setup;
    setup.script = parse_operator(lever, "lever");
    setup.start = around.seen;
    setup.tool_length = around.blade_length;
    Watched sensor(setup);
    devices::HapticLoop loop(node, sensor, link.newest(), {});
    bus::Node listener(place(here, domain, "listener"));
    RoundTrips trips(listener);
    bus::Subscriber<msg::SessionStatus> status_topic(listener, bus::topics::session_status);
    msg::SessionStatus status;
    LiveOutcome out;
    for (const auto end = Clock::now() + std::chrono::duration<double>(live.seconds); Clock::now() < end;) {
        trips.watch();
        if (status_topic.take_latest(status)) {
            out.server_behind = static_cast<double>(status.behind_s());
        }
    }
    server.check();
    loop.stop();

    const devices::HapticRecord& record = loop.cycle().record();
    const auto count = static_cast<double>(record.intervals.count() + 1);
    out.loop = timing_of(loop);
    out.round_trip_p50 = trips.percentile(0.5);
    out.round_trip_p99 = trips.percentile(0.99);
    out.force_mean = record.force_sum / count;
    out.force_max = static_cast<double>(record.force_max);
    std::tie(out.excursion, out.min_excursion, out.held_force) = sensor.held();
    out.message_p99 = record.messages.percentile(0.99);
    out.message_max = record.messages.longest();
    out.stale_share = static_cast<double>(record.stale_cycles) / count;
    const devices::PassivityController& passivity = loop.cycle().renderer().passivity();
    out.energy_lowest = passivity.lowest();
    out.dissipated = passivity.dissipated();
    out.passivity_share = static_cast<double>(passivity.active_cycles()) / count;
    return out;
}

}  // namespace eti::bench
