// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "common/bus/bus.hpp"
#include "common/bus/codec/convert.hpp"
#include "common/model/runtime_parameters.hpp"
#include "synthetic_scene.hpp"
#include "tests/support/bus_domain.hpp"

namespace eti::synthetic {

[[nodiscard]] inline bus::Options bus_options(const std::string& name) {
    return test::bus_options(name, "client-test-" + std::to_string(::getpid()));
}

// Publishes the synthetic scene on a real bus, in steps of 30 ms of simulation time that begin once a client
// has matched. Its pace depends on the machine; the tests' expectations do not.
class SyntheticServer {
  public:
    /// Finishes after `seconds` of simulation time and `eyes` poses of the examiner's eye. `live`: initial
    /// runtime parameters.
    explicit SyntheticServer(double seconds, int eyes = 0, const RuntimeParameters& live = {})
        : finish_after_s_(seconds), finish_after_eyes_(eyes), live_(live), thread_([this] { run(); }) {}
    ~SyntheticServer() { stop(); }

    // Stops without notice, like a killed server.
    void stop() {
        stopping_ = true;
        if (thread_.joinable()) {
            thread_.join();
        }
    }
    [[nodiscard]] double time_s() const { return time_s_; }
    [[nodiscard]] int eyes() const { return eyes_; }
    [[nodiscard]] Vec3f eye() const { return last_eye_; }
    /// Commands received so far, as "name value".
    [[nodiscard]] std::vector<std::string> commands() const {
        const std::scoped_lock lock(mutex_);
        return commands_;
    }
    /// The server refuses this command and executes all others at once.
    static constexpr const char* refused = "reset";
    static constexpr const char* reason = "nothing has moved yet";

  private:
    void run() {
        const Scene scene = make_scene();
        bus::Node node(bus_options("eti-server"));
        bus::Publisher<msg::SessionDescription> description(node, bus::topics::session_description);
        bus::Publisher<msg::SceneDescription> objects(node, bus::topics::scene);
        bus::Publisher<msg::DeformationState> fast(node, bus::topics::deformation);
        bus::Publisher<msg::DeformationState> slow(node, bus::topics::deformation_slow);
        bus::Publisher<msg::ProxyState> proxy(node, bus::topics::proxy);
        bus::Publisher<msg::LiveMetrics> live(node, bus::topics::live_metrics);
        bus::Publisher<msg::SessionStatus> status(node, bus::topics::session_status);
        bus::Publisher<msg::AttemptSummary> summaries(node, bus::topics::attempt_summary);
        bus::Subscriber<msg::Command> commands(node, bus::topics::command);
        bus::Publisher<msg::CommandResult> answers(node, bus::topics::command_result);
        bus::Subscriber<msg::EyePose> eye(node, bus::topics::eye_pose);
        description.publish(scene.description);
        for (const auto& object : scene.objects) {
            objects.publish(object);
        }
        while (!stopping_) {
            if (fast.matched() + slow.matched() > 0) {
                time_s_ = time_s_ + 0.03;
            }
            const auto time_ns = static_cast<std::uint64_t>(1e9 * time_s_);
            const float lift = 0.002f * static_cast<float>(time_s_);
            fast.publish(deformation(scene, time_ns, lift, 0.01f));
            slow.publish(deformation(scene, time_ns, lift, 0.01f));
            proxy.publish(synthetic::proxy(scene, time_ns));
            // The view opens within a second and stays.
            auto measured = metrics(scene, time_ns, static_cast<float>(80.0 * std::min(1.0, time_s_.load())));
            bus::set_runtime_parameters(live_, measured);
            live.publish(measured);
            msg::Command command;
            while (commands.take(command)) {
                answers.publish(carry_out(command));
            }
            const bool finished = time_s_ > finish_after_s_ && eyes_ >= finish_after_eyes_;
            if (finished && !summed_up_) {
                summaries.publish(summary(1, true, time_ns));
                summaries.publish(summary(0, true, time_ns));
                summed_up_ = true;
            }
            status.publish(synthetic::status(finished ? msg::PHASE_FINISHED : msg::PHASE_RUNNING));
            status.assert_liveliness();
            msg::EyePose pose;
            while (eye.take(pose)) {
                last_eye_ =
                    Vec3f(pose.pose().position().x(), pose.pose().position().y(), pose.pose().position().z());
                ++eyes_;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(30));
        }
    }

    msg::CommandResult carry_out(const msg::Command& command) {
        const std::string name = command.name().to_string();
        {
            const std::scoped_lock lock(mutex_);
            commands_.push_back(fmt::format("{} {:.3f}", name, command.value()));
        }
        if (const RuntimeParameterField* const field = find_runtime_parameter(name)) {
            live_.*field->value = command.value();
        }
        msg::CommandResult answer;
        answer.recipient(command.sender());
        answer.id(command.id());
        answer.accepted(name != refused);
        answer.reason(name == refused ? reason : "");
        return answer;
    }

    double finish_after_s_;
    int finish_after_eyes_;
    bool summed_up_ = false;
    RuntimeParameters live_;
    mutable std::mutex mutex_;
    std::vector<std::string> commands_;
    std::atomic<bool> stopping_{false};
    std::atomic<int> eyes_{0};
    std::atomic<double> time_s_{0.0};
    Vec3f last_eye_ = Vec3f::Zero();
    std::thread thread_;
};

}  // namespace eti::synthetic
