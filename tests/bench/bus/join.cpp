// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>
#include <time.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>

#include "client/view/scene_view.hpp"
#include "common/bus/codec/convert.hpp"
#include "common/process/stop_signal.hpp"
#include "tests/bench/bus/parts.hpp"

namespace eti::bench {

namespace {

using namespace std::chrono_literals;

constexpr float same_place = 1e-6f;  // [m]; poses travel as floats

/// Start time of this process in seconds since boot: field 22 of /proc/self/stat, in ticks.
double began() {
    std::ifstream file("/proc/self/stat");
    std::string text;
    std::getline(file, text);
    std::istringstream rest(text.substr(text.rfind(')') + 2));
    std::string field;
    for (int i = 3; i <= 22; ++i) {
        rest >> field;
    }
    return std::stod(field) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

}  // namespace

double since_start_ms() {
    static const double start = began();
    timespec now{};
    ::clock_gettime(CLOCK_BOOTTIME, &now);
    return 1e3 * (static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) - start);
}

nlohmann::json join(const PartOptions& options) {
    nlohmann::json at = nlohmann::json::object();
    const auto note = [&](const char* what) {
        if (!at.contains(what)) {
            at[what] = since_start_ms();
        }
    };
    bus::Node node(options.bus);
    bus::Subscriber<msg::SessionDescription> description_topic(node, bus::topics::session_description);
    bus::Subscriber<msg::SceneDescription> scene_topic(node, bus::topics::scene);
    bus::Subscriber<msg::DeformationState> state_topic(node, bus::topics::deformation_slow);
    bus::Subscriber<msg::ProxyState> proxy_topic(node, bus::topics::proxy);
    std::optional<bus::Publisher<msg::ToolPose>> pose_topic;
    if (options.drive) {
        pose_topic.emplace(node, bus::topics::laryngoscope_pose);
    }
    note("participant");
    // A unique position, so that a proxy that answers another device's pose does not count.
    const Vec3f place(0.0f, -0.3f, 0.2f + 1e-4f * static_cast<float>(::getpid() % 1000));
    msg::ToolPose pose;
    pose.pose(bus::to_msg(RigidTransform::from(Quatf::Identity(), place)));
    msg::SessionDescription description;
    msg::SceneDescription object;
    msg::DeformationState state;
    msg::ProxyState proxy;
    view::SceneView scene;
    std::uint32_t number = 0;
    const char* const whole = options.drive ? "answered" : "state";
    const auto end = Clock::now() + std::chrono::duration<double>(options.wait_s);
    while (!(at.contains("scene") && at.contains("proxy") && at.contains(whole))) {
        if (stop_requested() || Clock::now() > end) {
            break;
        }
        while (description_topic.take(description)) {
            scene.apply(description);
            note("description");
        }
        while (scene_topic.take(object)) {
            note("first_object");
            scene.apply(object);
        }
        if (scene.complete()) {
            note("scene");
        }
        while (state_topic.take(state)) {
            note("state");
        }
        while (proxy_topic.take(proxy)) {
            note("proxy");
            if ((bus::from_msg(proxy.device().position()) - place).norm() < same_place) {
                note("answered");
            }
        }
        if (pose_topic) {
            pose.header(bus::make_header(0, ++number));
            pose_topic->publish(pose);
        }
        std::this_thread::sleep_for(1ms);
    }
    at["joined"] = at.contains("scene") && at.contains("proxy") && at.contains(whole);
    if (options.stay_s > 0.0) {
        fmt::print("{}\n", at.dump());
        std::fflush(stdout);
        for (const auto until = Clock::now() + std::chrono::duration<double>(options.stay_s);
             Clock::now() < until && !stop_requested();) {
            while (state_topic.take(state) || proxy_topic.take(proxy)) {
            }
            if (pose_topic) {
                pose.header(bus::make_header(0, ++number));
                pose_topic->publish(pose);
            }
            std::this_thread::sleep_for(1ms);
        }
        return nullptr;
    }
    return at;
}

}  // namespace eti::bench
