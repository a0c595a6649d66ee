// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/app/command_link.hpp"

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>

#include "common/bus/convert.hpp"
#include "common/model/live.hpp"
#include "common/scenario/preset.hpp"
#include "common/scenario/scenario.hpp"

namespace eti::devices {

std::string command_keys() {
    std::string text;
    for (const LiveField& field : live_fields) {
        text +=
            fmt::format("{}{} ({:g} to {:g})", text.empty() ? "" : ", ", field.key(), field.low, field.high);
    }
    return text;
}

// The range is the server's to check: it knows what its patient bears.
PadCommand command_from(const std::string& typed) {
    const std::size_t equals = typed.find('=');
    const auto field = std::ranges::find(live_fields, typed.substr(0, equals), &LiveField::key);
    if (equals == std::string::npos || field == live_fields.end()) {
        throw InputError(fmt::format("--set {}: expected KEY=VALUE with a key of {}", typed, command_keys()));
    }
    const std::string wanted = typed.substr(equals + 1);
    if (field->on_off && (wanted == "on" || wanted == "off")) {
        return {field->name, wanted == "on" ? 1.0f : 0.0f};
    }
    float value = 0.0f;
    const char* const end = wanted.data() + wanted.size();
    const auto [stop, error] = std::from_chars(wanted.data(), end, value);
    if (error != std::errc() || stop != end) {
        throw InputError(fmt::format("--set {}: expected {} after '=', {:g} to {:g}", typed,
                                     field->on_off ? "on, off or a plain number" : "a plain number",
                                     field->low, field->high));
    }
    return {field->name, value * field->per_unit};
}

std::vector<PadCommand> commands_of_preset(const std::string& name_or_path) {
    std::vector<PadCommand> out;
    for (const Preset::Value& value : load_preset(find_data_file(name_or_path, "presets")).values) {
        out.push_back({value.field->name, value.value});
    }
    return out;
}

CommandLink::CommandLink(const bus::Options& options)
    : node_(options),
      commands_(node_, "eti-controller"),
      status_(node_, bus::topics::session_status),
      description_topic_(node_, bus::topics::session_description),
      live_(node_, bus::topics::live_metrics) {}

void CommandLink::send(const PadCommand& command) {
    if (!commands_.send(command.name, command.value)) {
        spdlog::warn("a command could not be sent: no server takes it");
    }
}

void CommandLink::poll() {
    (void)commands_.take_answers();
    if (!served()) {
        bus::refuse_other_protocol(node_);
    }
    msg::SessionStatus status;
    while (status_.take(status)) {
        session_finished_ = session_finished_ || status.phase() == msg::PHASE_FINISHED;
        say_device("laryngoscope", status.laryngoscope(), laryngoscope_);
        say_device("tube", status.tube(), tube_);
    }
    msg::SessionDescription description;
    while (description_topic_.take(description)) {
        std::string why;
        keys_ = bus::SessionKeys::of(description, why);
        if (keys_) {
            description_ = description;
        } else {
            spdlog::warn("the session's description cannot be right: {}", why);
        }
    }
    msg::LiveMetrics live;
    if (keys_ && live_.take_latest(live)) {
        now_ = live.live();
        patient_ = keys_->live(live);
    }
}

void CommandLink::say_device(const char* tool, msg::DevicePresence now, msg::DevicePresence& said) {
    if (now == msg::DEVICE_SILENT && said != now) {
        spdlog::warn("the {}'s device is silent", tool);
    } else if (now == msg::DEVICE_HEARD && said == msg::DEVICE_SILENT) {
        spdlog::info("the {}'s device is back", tool);
    }
    said = now;
}

bool CommandLink::wait_for_answers(std::chrono::milliseconds patience) {
    const auto limit = std::chrono::steady_clock::now() + patience;
    const auto answered = [this] { return accepted() + refused() == sent(); };
    while (!answered() && std::chrono::steady_clock::now() < limit) {
        (void)commands_.wait(std::chrono::milliseconds(50));
        poll();
    }
    return answered();
}

}  // namespace eti::devices
