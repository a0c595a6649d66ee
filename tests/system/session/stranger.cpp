// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// A participant that violates the session's rules, for tests: eti-stranger WHAT [session options].
#include <fmt/format.h>

#include <thread>

#include "common/bus/bus.hpp"
#include "common/bus/codec/convert.hpp"
#include "common/bus/command_line.hpp"
#include "common/process/command_line.hpp"

namespace eti {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// Calls `send` `rate` times a second for `seconds`, once a reader has matched or two seconds have passed.
template <class Message, class Send>
std::uint64_t send_at(double rate, double seconds, bus::Publisher<Message>& topic, const Send& send) {
    for (int i = 0; i < 200 && topic.matched() == 0; ++i) {
        std::this_thread::sleep_for(10ms);
    }
    const auto start = Clock::now();
    std::uint64_t sent = 0;
    while (true) {
        const double elapsed = std::chrono::duration<double>(Clock::now() - start).count();
        if (elapsed > seconds) {
            return sent;
        }
        while (static_cast<double>(sent) < elapsed * rate) {
            send(static_cast<std::uint32_t>(++sent));
        }
        std::this_thread::sleep_for(1ms);
    }
}

/// A proxy that pulls the hand a centimetre away.
std::uint64_t pull(bus::Node& node, double seconds) {
    bus::Publisher<msg::ProxyState> topic(node, bus::topics::proxy);
    return send_at(180.0, seconds, topic, [&](std::uint32_t number) {
        RigidTransform pose;
        msg::ProxyState message;
        message.header(bus::make_header(std::uint64_t{number} * 5'555'556, number));
        message.device(bus::to_msg(pose));
        pose.translation = {0.0f, 0.01f, 0.0f};
        message.proxy(bus::to_msg(pose));
        message.contacts().resize(1);
        message.contacts()[0].normal(bus::to_msg(Vec3f(0.0f, 1.0f, 0.0f)));
        message.contacts()[0].force(8.0f);
        topic.publish(message);
    });
}

std::uint64_t end_session(bus::Node& node, double seconds) {
    bus::Publisher<msg::SessionStatus> topic(node, bus::topics::session_status);
    return send_at(20.0, seconds, topic, [&](std::uint32_t number) {
        msg::SessionStatus message;
        message.session(node.options().session);
        message.header(bus::make_header(0, number));
        message.phase(msg::PHASE_FINISHED);
        message.server("forged:1");
        topic.publish(message);
    });
}

/// The frames of a nonexistent patient, under the names of the real ones.
std::uint64_t show_scene(bus::Node& node, double seconds) {
    bus::Publisher<msg::SceneDescription> topic(node, bus::topics::scene);
    return send_at(20.0, seconds, topic, [&](std::uint32_t number) {
        for (const char* const object : {"frames", "head", "laryngoscope"}) {
            msg::SceneDescription message;
            message.object(object);
            message.header(bus::make_header(0, number));
            message.object_count(3);
            message.kind(object[0] == 'f' ? msg::OBJECT_FRAMES : msg::OBJECT_SURFACE);
            message.vertices({0, 0, 0, 1, 0, 0, 0, 1, 0});
            topic.publish(message);
        }
    });
}

std::uint64_t command(bus::Node& node, double seconds, double rate) {
    bus::Publisher<msg::Command> topic(node, bus::topics::command);
    return send_at(rate, seconds, topic, [&](std::uint32_t number) {
        msg::Command message;
        message.header(bus::make_header(0, number));
        message.sender("stranger");
        message.id(number);
        message.name("suction");
        message.value(static_cast<float>(number % 2));
        topic.publish(message);
    });
}

std::uint64_t move_blade(bus::Node& node, double seconds) {
    bus::Publisher<msg::ToolPose> topic(node, bus::topics::laryngoscope_pose);
    return send_at(1000.0, seconds, topic, [&](std::uint32_t number) {
        msg::ToolPose message;
        message.header(bus::make_header(0, number));
        RigidTransform pose;
        pose.translation = {1.0f, 1.0f, 1.0f};
        message.pose(bus::to_msg(pose));
        topic.publish(message);
    });
}

}  // namespace
}  // namespace eti

int main(int argc, char** argv) {
    using namespace eti;
    CommandLine app("Does what a program of the session should not.", "eti-stranger");
    bus::Options options{.name = "stranger"};
    std::string what;
    double seconds = 3.0, rate = 10'000.0;
    app.add_option("what", what).required().one_of({"pull", "end", "scene", "command", "move"});
    app.add_number("--seconds", seconds, "How long", {0.0, 3600.0, "s"});
    app.add_number("--rate", rate, "Of commands", {1.0, 1e6, "a second"});
    app.add_option("--name", options.name, "How it introduces itself");
    bus::add_options(app, options);
    if (const auto status = app.parse(argc, argv)) {
        return *status;
    }
    bus::Node node(options);
    const std::uint64_t sent = what == "pull"    ? pull(node, seconds)
                               : what == "end"   ? end_session(node, seconds)
                               : what == "scene" ? show_scene(node, seconds)
                               : what == "move"  ? move_blade(node, seconds)
                                                 : command(node, seconds, rate);
    fmt::print("{}\n", sent);
    return 0;
}
