// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/window/windowed.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "client/app/annotator.hpp"
#include "client/app/controls.hpp"
#include "client/app/session_input.hpp"
#include "client/app/session_sound.hpp"
#include "client/app/window/compositor.hpp"
#include "client/app/window/hand_controls.hpp"
#include "client/app/window/window.hpp"
#include "client/app/window/window_panel.hpp"
#include "client/render/gl/headless_context.hpp"
#include "common/process/priority.hpp"
#include "common/process/stop_signal.hpp"

namespace eti::client {
namespace {

constexpr int window_nice = 5;
constexpr auto shortest_frame = std::chrono::milliseconds(11);
constexpr auto instruction_delivery_wait = std::chrono::milliseconds(500);  // for the last annotation

/// What an instructor sends besides commands.
struct Instruction {
    explicit Instruction(bus::Node& node)
        : publisher(node, bus::topics::annotation),
          annotator(bus::process_name().substr(0, msg::bound::Annotation_sender),
                    [this](const msg::Annotation& annotation) {
                        return publisher.matched() > 0 && publisher.publish(annotation);
                    }) {}
    bus::Publisher<msg::Annotation> publisher;
    Annotator annotator;
};

bool lost(const SessionInput& input) {
    return (input.presence() == ServerPresence::gone || input.presence() == ServerPresence::silent) &&
           input.presence_for_s() > lost_after_s;
}

}  // namespace

int run_windowed(const Options& options, nlohmann::json& result) {
    lower_priority(window_nice);
    Window window(options.width, options.height, "NeoETI - " + options.bus.session);
    bus::Node node(options.bus);
    SessionInput input(node, !options.observe, options.is_trainee());
    std::optional<bus::CommandSender> commands;
    if (!options.observe) {
        commands.emplace(node, options.bus.name);
    }
    const auto sound = session_sound(options.sound, options.volume);
    std::optional<HandControls> hands;
    if (options.hands) {
        hands.emplace(node, options.play, options.tutorial);
    }
    Controls controls(*options.selection, commands ? &*commands : nullptr, options.vantage);
    WindowPanel panel(window, node, commands ? &*commands : nullptr, options.panel);
    std::optional<Instruction> instruction;
    if (options.instructor) {
        instruction.emplace(node);
        controls.set_annotator(instruction->annotator);
    }
    if (!options.is_trainee()) {
        controls.allow_trainee_view(options.instructor);
    }
    view::SceneView scene;
    Compositor compositor(window.width(), window.height(),
                          options.quality != nullptr ? *options.quality : render::affordable_quality());
    compositor.bake_in_background();
    spdlog::info("drawing with {}, quality {}", render::driver_name(), compositor.quality().name);
    std::uint64_t frames = 0;
    bool was_lost = false;
    auto served_at = std::chrono::steady_clock::now();
    while (window.open() && !stop_requested() && (options.frames == 0 || frames < options.frames)) {
        const auto now = std::chrono::steady_clock::now();
        const auto next_frame = now + shortest_frame;
        window.intercept_escape(controls.writing() || panel.has_keyboard());
        panel.poll_events();
        input.receive_into(scene);
        if (!scene.complete() || was_lost) {
            bus::refuse_other_protocol(node);
        }
        // A server that is present but still builds its patient may exceed any timeout.
        served_at = input.server_on_bus() ? now : served_at;
        if (options.wait_s && now - served_at > std::chrono::duration<double>(*options.wait_s)) {
            throw bus::BusError(fmt::format("no server for {} s (--wait): {}", *options.wait_s,
                                            bus::missing_server_message(options.bus)));
        }
        for (const KeyEvent& event : window.take_keys()) {
            if (event.down && controls.writing()) {
                controls.type(event.typed != 0 ? event.typed : event.key, now);
                continue;
            }
            if (panel.press(event) || (hands && hands->key(event))) {
                continue;
            }
            event.down ? controls.press(event.key, event.repeated, scene, now)
                       : controls.release(event.key, now);
        }
        const panel::Area area = panel.scene_area();
        for (const hands::Drag& mouse : window.take_drags()) {
            if (!panel.has_mouse() &&
                (!hands || !hands->drag(mouse, controls, scene, area.width, area.height))) {
                controls.drag(mouse, scene, area.width, area.height, now);
            }
        }
        controls.follow(scene);
        controls.update(now);
        panel.follow(scene, input, controls.refusals(), now);
        scene.update();
        if (lost(input) != was_lost) {
            was_lost = !was_lost;
            spdlog::warn(was_lost ? "the server is lost; waiting for one" : "a server is back");
        }
        const Selection& selection = hands ? hands->shown(controls.selection()) : controls.selection();
        if (hands) {
            (void)hands->update(scene, selection);
        }
        if (sound) {
            sound->set_cue(cue_of(scene, was_lost));
        }
        if (const auto shown = visible_views(selection, scene, window.minimised())) {
            compositor.resize(area.width, area.height);
            hud::Readout readout = hud::make_readout(scene, was_lost, node.contested());
            if (hands) {
                hands->add_to(readout);
            }
            controls.add_to(readout, now);
            if (hands && !readout.keys.empty()) {
                readout.keys = HandControls::help();
            }
            if (!readout.keys.empty()) {
                readout.keys.emplace_back("quality", compositor.quality().name);
            }
            compositor.draw(*shown, scene, readout, controls.vantage(), options.json, selection.arrangement);
            // OpenGL counts rows from below.
            compositor.target().copy_to(
                0, {0, 0, area.width, area.height},
                {area.x, window.height() - area.y - area.height, area.width, area.height});
            panel.draw(now);
            window.swap_buffers();
        }
        input.publish_eye(scene, controls.vantage().eye);
        if (scene.complete() && ++frames == 1) {
            spdlog::info("shows the patient");
        }
        // Without vertical sync the loop would occupy every core with the same picture.
        std::this_thread::sleep_until(next_frame);
    }
    controls.release_all_keys(std::chrono::steady_clock::now());
    if (instruction) {
        instruction->publisher.wait_until_received(instruction_delivery_wait);
    }
    result = {{"session", options.bus.session},
              {"view", std::string(controls.selection().name)},
              {"scenarios", input.scenarios()},
              {"end", stop_requested() ? "stopped" : "closed"},
              {"simulation_time_s", 1e-9 * static_cast<double>(scene.simulation_time_ns())},
              {"frames", frames},
              {"quality", std::string(compositor.quality().name)},
              {"messages_dropped", scene.dropped()},
              {"states_missed", input.arrival().missed()},
              {"state_age_ms", {{"mean", input.arrival().mean_ms()}, {"max", input.arrival().max_ms()}}}};
    if (hands) {
        result["hands"] = hands->report();
    }
    if (commands) {
        (void)commands->take_answers();
        result["commands"] = {
            {"sent", commands->sent()}, {"accepted", commands->accepted()}, {"refused", commands->refused()}};
    }
    return 0;
}

}  // namespace eti::client
