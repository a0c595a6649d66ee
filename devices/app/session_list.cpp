// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/app/session_list.hpp"

#include <fmt/format.h>

namespace eti::devices {

using nlohmann::ordered_json;

ordered_json session_list(const bus::msg::SessionDescription& session, std::span<const float> now) {
    const auto names = [](const auto& texts) {
        ordered_json out = ordered_json::array();
        for (const auto& text : texts) {
            out.push_back(text.to_string());
        }
        return out;
    };
    ordered_json out{{"session", session.session().to_string()},
                     {"version", session.version().to_string()},
                     {"scenario", session.scenario().to_string()},
                     {"description", session.description().to_string()},
                     {"patient_weight_kg", session.patient_weight_kg()},
                     {"time_limit_s", session.time_limit_s()},
                     {"steps_per_second", session.steps_per_second()},
                     {"blade", session.blade().to_string()},
                     {"tube_inner_diameter_mm", 1e3f * session.tube_inner_diameter()},
                     {"tissues", names(session.tissues())}};
    out["live"] = ordered_json::array();
    for (std::size_t i = 0; i < session.live().size(); ++i) {
        const bus::msg::LiveKey& key = session.live()[i];
        ordered_json row{{"name", key.name().to_string()},
                         {"label", key.label().to_string()},
                         {"unit", key.unit().to_string()},
                         {"low", key.low()},
                         {"high", key.high()},
                         {"start", key.start() / key.per_unit()},
                         {"rate", key.relative() ? key.rate() : key.rate() / key.per_unit()},
                         {"relative", key.relative()},
                         {"on_off", key.on_off()},
                         {"help", key.help().to_string()}};
        row["now"] = i < now.size() ? ordered_json(now[i] / key.per_unit()) : ordered_json();
        out["live"].push_back(row);
    }
    out["parameters"] = ordered_json::array();
    for (const bus::msg::ParameterKey& key : session.parameters()) {
        out["parameters"].push_back({{"name", key.name().to_string()},
                                     {"label", key.label().to_string()},
                                     {"unit", key.unit().to_string()}});
    }
    out["scenario_text"] = session.scenario_text();
    return out;
}

std::string session_text(const ordered_json& list) {
    std::string out =
        fmt::format("session '{}': scenario '{}', server of version {}, newborn of {:.3g} kg\n",
                    list["session"].get<std::string>(), list["scenario"].get<std::string>(),
                    list["version"].get<std::string>(), list["patient_weight_kg"].get<double>());
    if (const auto about = list["description"].get<std::string>(); !about.empty()) {
        out += about + "\n";
    }
    for (const ordered_json& row : list["live"]) {
        const auto number = [&](const char* key) {
            return row[key].is_number() ? fmt::format("{:.4g}", row[key].get<double>()) : std::string("-");
        };
        out += fmt::format("  {:<24} {:>8} {:<4} {} to {}: {}\n", row["label"].get<std::string>(),
                           number("now"), row["unit"].get<std::string>(), number("low"), number("high"),
                           row["help"].get<std::string>());
    }
    return out;
}

}  // namespace eti::devices
