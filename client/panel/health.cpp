// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/panel/health.hpp"

#include <fmt/format.h>

#include "client/text/catalogue.hpp"

namespace eti::panel {
namespace {

using hud::Level;

std::string text_of(std::string_view english) {
    return std::string(text::translate(english));
}

// Above its step budget the server falls behind; near it there is no reserve for bursts.
constexpr float load_warning = 0.85f, load_bad = 1.0f;
constexpr float behind_warning_s = 0.1f, behind_bad_s = 0.5f;
// Deformation arrives at 90 or 30 Hz: at these ages picture and hand visibly diverge.
constexpr double age_warning_ms = 50.0, age_bad_ms = 150.0;
constexpr double missed_warning = 0.001, missed_bad = 0.01;  // fractions
constexpr double silence_warning_s = 0.3, silence_bad_s = 1.0;

template <class Number>
Level level_of(Number value, Number warning, Number bad) {
    return value >= bad ? Level::bad : value >= warning ? Level::warning : Level::good;
}

HealthLine device(std::string label, msg::DevicePresence presence) {
    switch (presence) {
        case msg::DEVICE_HEARD:
            return {std::move(label), text_of("sending"), Level::good};
        case msg::DEVICE_SILENT:
            return {std::move(label), text_of("silent"), Level::bad};
        case msg::DEVICE_NONE:
            break;
    }
    return {std::move(label), text_of("none"), Level::neutral};
}

}  // namespace

std::vector<HealthLine> health_of(const view::SceneView& scene, const Connection& connection,
                                  double silent_s) {
    std::vector<HealthLine> out;
    if (const auto& status = scene.status()) {
        out.push_back({text_of("server"), status->server().to_string(), Level::neutral});
        out.push_back({text_of("last status"), text::translate_format("{:.1f} s ago", silent_s),
                       level_of(silent_s, silence_warning_s, silence_bad_s)});
        out.push_back({text_of("load"), text::translate_format("{:.0f} % of a step", 100.0f * status->load()),
                       level_of(status->load(), load_warning, load_bad)});
        out.push_back({text_of("behind the clock"), fmt::format("{:.2f} s", status->behind_s()),
                       level_of(status->behind_s(), behind_warning_s, behind_bad_s)});
        out.push_back(device(text_of("laryngoscope's device"), status->laryngoscope()));
        out.push_back(device(text_of("tube's device"), status->tube()));
    } else {
        out.push_back({text_of("server"), text_of("no data yet"), Level::bad});
    }
    if (connection.contested) {
        out.push_back({text_of("session"), text_of("two servers: stop one"), Level::bad});
    }
    if (connection.states > 0) {
        out.push_back({text_of("shapes' age, mean"), fmt::format("{:.1f} ms", connection.state_age_mean_ms),
                       level_of(connection.state_age_mean_ms, age_warning_ms, age_bad_ms)});
        out.push_back({text_of("shapes' age, max"), fmt::format("{:.1f} ms", connection.state_age_max_ms),
                       Level::neutral});
        const double share = static_cast<double>(connection.states_missed) /
                             static_cast<double>(connection.states + connection.states_missed);
        out.push_back({text_of("shapes lost"),
                       fmt::format("{} ({:.2f} %)", connection.states_missed, 100.0 * share),
                       level_of(share, missed_warning, missed_bad)});
    }
    out.push_back({text_of("messages dropped"), fmt::format("{}", scene.dropped()),
                   scene.dropped() > 0 ? Level::bad : Level::good});
    out.push_back({text_of("commands"),
                   text::translate_format("{} sent, {} accepted, {} refused", connection.sent,
                                          connection.accepted, connection.refused),
                   Level::neutral});
    for (const std::string& program : connection.programs) {
        out.push_back({text_of("on the bus"), program, Level::neutral});
    }
    return out;
}

}  // namespace eti::panel
