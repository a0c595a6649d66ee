// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "client/panel/model.hpp"
#include "client/view/scene_view.hpp"
#include "common/bus/codec/convert.hpp"
#include "common/bus/security/session_keys.hpp"
#include "synthetic_scene.hpp"

namespace eti::test {

using namespace std::chrono_literals;

/// A model and a server under the test's control: no bus, no clock.
struct PanelScene {
    using Sent = std::vector<std::pair<std::string, float>>;

    explicit PanelScene(bool commands = true, Presets presets = {})
        : model(commands ? panel::Model::Send([this](std::string_view name, float value) {
                    if (served) {
                        sent.emplace_back(name, value);
                    }
                    return served;
                })
                         : panel::Model::Send(),
                std::move(presets)) {
        synthetic::fill(scene, source);
    }

    /// Publishes the state, `seconds` later on both clocks.
    void say(double seconds = 1.0 / 30.0) {
        time_s += seconds;
        now += std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(seconds));
        const auto time_ns = static_cast<std::uint64_t>(1e9 * time_s);
        auto metrics = synthetic::metrics(source, time_ns, opening);
        bus::set_runtime_parameters(live, metrics);
        metrics.parameters(bus::to_msg(manikin ? synthetic::manikin_metrics() : initial_metrics()));
        synthetic::set(metrics, &LiveMeasures::gum_force_n, gum_force);
        synthetic::set(metrics, &LiveMeasures::tube_depth_past_glottis, tube_depth);
        // Optional measures without a value have no plot.
        synthetic::set(metrics, &LiveMeasures::tube_force_n, LiveMeasures::missing);
        scene.apply(metrics);
        auto status = synthetic::status(msg::PHASE_RUNNING);
        status.header().send_time_ns(time_ns);
        status.laryngoscope(msg::DEVICE_HEARD);
        status.load(load);
        scene.apply(status);
        model.follow(scene, connection, now);
    }
    [[nodiscard]] std::size_t row(std::string_view name) const {
        for (std::size_t i = 0; i < model.rows().size(); ++i) {
            if (model.rows()[i].name == name) {
                return i;
            }
        }
        throw std::runtime_error("no row " + std::string(name));
    }
    [[nodiscard]] const panel::ParameterRow& at(std::string_view name) const {
        return model.rows()[row(name)];
    }

    synthetic::Scene source = synthetic::make_scene();
    view::SceneView scene;
    panel::Connection connection;
    RuntimeParameters live;
    float opening = 40.0f, gum_force = 1.5f, tube_depth = 0.01f, load = 0.5f;
    bool served = true, manikin = false;
    double time_s = 1.0;
    panel::Model::Time now = panel::Model::Time(100s);
    Sent sent;
    panel::Model model;
};

}  // namespace eti::test
