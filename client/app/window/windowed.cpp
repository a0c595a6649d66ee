// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/window/windowed.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "client/app/client_session.hpp"
#include "client/app/window/compositor.hpp"
#include "client/app/window/window.hpp"
#include "client/app/window/window_panel.hpp"
#include "client/render/gl/headless_context.hpp"
#include "client/text/catalogue.hpp"
#include "common/process/stop_signal.hpp"
#include "common/process/threads/priority.hpp"

namespace eti::client {
namespace {

constexpr int window_nice = 5;
constexpr auto shortest_frame = std::chrono::milliseconds(11);

}  // namespace

int run_windowed(const Options& options, nlohmann::json& result) {
    lower_priority(window_nice);
    Window window(options.width, options.height, "NeoETI - " + options.bus.session);
    ClientSession session(options);
    WindowPanel panel(window, *session.panel, options.panel, options.text_scale);
    Compositor compositor(window.width(), window.height(), options.drawing_quality());
    compositor.bake_in_background();
    compositor.set_text_scale(options.text_scale);
    spdlog::info("rendering with {}, quality {}", render::driver_name(), compositor.quality().name);
    std::uint64_t frames = 0;
    auto served_at = std::chrono::steady_clock::now();
    while (window.open() && !stop_requested() && (options.frames == 0 || frames < options.frames)) {
        const auto now = std::chrono::steady_clock::now();
        const auto next_frame = now + shortest_frame;
        window.intercept_escape(session.controls.writing() || panel.has_keyboard());
        panel.poll_events();
        session.receive();
        // A server that is present but still builds its patient may exceed any timeout.
        served_at = session.input.server_on_bus() ? now : served_at;
        if (options.wait_s && now - served_at > std::chrono::duration<double>(*options.wait_s)) {
            throw bus::BusError(fmt::format("no server found for {} s (--wait): {}", *options.wait_s,
                                            bus::missing_server_message(options.bus)));
        }
        for (const KeyEvent& event : window.take_keys()) {
            if (session.controls.writing() || !panel.press(event)) {
                session.key(event, now);
            }
        }
        const panel::Area area = panel.scene_area();
        for (const hands::Drag& mouse : window.take_drags()) {
            if (!panel.has_mouse()) {
                session.drag(mouse, area.width, area.height, now);
            }
        }
        (void)session.update(now);
        session.scene.update();
        const Selection& selection = session.selection();
        if (const auto shown = visible_views(selection, session.scene, window.minimised())) {
            compositor.resize(area.width, area.height);
            hud::Readout readout = session.readout(now);
            if (!readout.keys.empty()) {
                readout.keys.emplace_back(text::translate("quality"), compositor.quality().name);
            }
            compositor.draw(*shown, session.scene, readout, session.controls.vantage(), options.json,
                            selection.arrangement);
            // OpenGL counts rows from below.
            compositor.target().copy_to(
                0, {0, 0, area.width, area.height},
                {area.x, window.height() - area.y - area.height, area.width, area.height});
            panel.draw(now);
            window.swap_buffers();
        }
        session.input.publish_eye(session.scene, session.controls.vantage().eye);
        if (session.scene.complete() && ++frames == 1) {
            spdlog::info("showing the patient");
        }
        // Without vertical sync the loop would occupy every core with the same picture.
        std::this_thread::sleep_until(next_frame);
    }
    session.finish();
    result = session.report(stop_requested() ? "stopped" : "closed", frames);
    result["quality"] = std::string(compositor.quality().name);
    return 0;
}

}  // namespace eti::client
