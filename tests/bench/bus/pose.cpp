// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <thread>
#include <vector>

#include "common/bus/codec/convert.hpp"
#include "common/process/stop_signal.hpp"
#include "common/process/threads/priority.hpp"
#include "tests/bench/bus/parts.hpp"
#include "tests/bench/bus/percentiles.hpp"

namespace eti::bench {

namespace {

using namespace std::chrono_literals;

template <class Endpoint>
bool meets(const Endpoint& endpoint, double patience_s) {
    const auto end = Clock::now() + std::chrono::duration<double>(patience_s);
    while (endpoint.matched() == 0) {
        if (stop_requested() || Clock::now() > end) {
            return false;
        }
        std::this_thread::sleep_for(5ms);
    }
    return true;
}

}  // namespace

nlohmann::json write_poses(const PartOptions& options) {
    const RealTimeThreads real_time(priority::bus);
    bus::Node node(options.bus);
    bus::Publisher<msg::ToolPose> topic(node, bus::topics::laryngoscope_pose);
    if (!meets(topic, options.wait_s)) {
        return {{"matched", false}};
    }
    // The other endpoint needs time to match.
    std::this_thread::sleep_for(500ms);
    msg::ToolPose pose;
    pose.pose(bus::to_msg(RigidTransform{}));
    const auto period =
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / options.rate));
    const auto count = static_cast<std::uint32_t>(options.seconds * options.rate);
    auto due = Clock::now();
    for (std::uint32_t number = 1; number <= count && !stop_requested(); ++number) {
        std::this_thread::sleep_until(due += period);
        pose.header(bus::make_header(0, number));
        topic.publish(pose);
    }
    return {{"matched", true}, {"sent", count}, {"real_time", real_time.refusal().empty()}};
}

nlohmann::json read_poses(const PartOptions& options) {
    const RealTimeThreads real_time(priority::bus);
    bus::Node node(options.bus);
    // The server keeps only the newest. This reader keeps all, so that a missing sample was lost, not
    // replaced by a newer one while this reader waited for a processor.
    auto all = bus::topics::laryngoscope_pose;
    all.qos.depth = 4096;
    bus::Subscriber<msg::ToolPose> topic(node, all);
    if (!meets(topic, options.wait_s)) {
        return {{"matched", false}};
    }
    std::vector<double> ages;
    msg::ToolPose pose;
    std::uint32_t first = 0, last = 0;
    // The writer begins half a second after matching this reader, and a lossy link takes longer.
    for (auto quiet_at = Clock::now() + 5s; Clock::now() < quiet_at && !stop_requested();) {
        if (!topic.wait(100ms)) {
            continue;
        }
        while (topic.take(pose)) {
            const auto now = static_cast<double>(bus::wall_clock_ns());
            ages.push_back(1e-3 * (now - static_cast<double>(pose.header().send_time_ns())));
            first = first == 0 ? pose.header().number() : first;
            last = pose.header().number();
            quiet_at = Clock::now() + 1s;
        }
    }
    nlohmann::json out{
        {"matched", true}, {"real_time", real_time.refusal().empty()}, {"age_us", percentiles(ages)}};
    if (last > 0) {
        out["expected"] = last - first + 1;
        out["arrived"] = ages.size();
    }
    return out;
}

}  // namespace eti::bench
