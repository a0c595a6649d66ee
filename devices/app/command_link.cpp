// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/app/command_link.hpp"

#include <spdlog/spdlog.h>

#include "common/bus/codec/convert.hpp"
#include "common/scenario/data_file.hpp"
#include "common/scenario/preset.hpp"
#include "common/scenario/setting.hpp"

namespace eti::devices {

PadCommand command_from(const std::string& typed) {
    const RuntimeParameterSetting setting = parse_runtime_parameter(typed);
    return {setting.field->name, setting.value};
}

std::vector<PadCommand> commands_of_preset(const std::string& name_or_path) {
    std::vector<PadCommand> out;
    for (const RuntimeParameterSetting& value : load_preset(find_data_file(name_or_path, "presets")).values) {
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
        spdlog::warn("cannot send a command: no server accepts commands");
    }
}

void CommandLink::poll() {
    (void)commands_.take_answers();
    if (!has_server()) {
        bus::refuse_other_protocol(node_);
    }
    msg::SessionStatus status;
    while (status_.take(status)) {
        session_finished_ = session_finished_ || status.phase() == msg::PHASE_FINISHED;
        log_device_change("laryngoscope", status.laryngoscope(), laryngoscope_);
        log_device_change("tube", status.tube(), tube_);
    }
    msg::SessionDescription description;
    while (description_topic_.take(description)) {
        std::string why;
        keys_ = bus::SessionKeys::of(description, why);
        if (keys_) {
            description_ = description;
        } else {
            spdlog::warn("invalid description of the session: {}", why);
        }
    }
    msg::LiveMetrics live;
    if (keys_ && live_.take_latest(live)) {
        now_ = live.live();
        patient_ = keys_->runtime_parameters(live);
    }
}

void CommandLink::log_device_change(const char* tool, msg::DevicePresence now, msg::DevicePresence& said) {
    if (now == msg::DEVICE_SILENT && said != now) {
        spdlog::warn("the {}'s device is silent", tool);
    } else if (now == msg::DEVICE_HEARD && said == msg::DEVICE_SILENT) {
        spdlog::info("the {}'s device is back", tool);
    }
    said = now;
}

bool CommandLink::wait_for_answers(std::chrono::milliseconds timeout) {
    const auto limit = std::chrono::steady_clock::now() + timeout;
    const auto answered = [this] { return accepted() + refused() == sent(); };
    while (!answered() && std::chrono::steady_clock::now() < limit) {
        (void)commands_.wait(std::chrono::milliseconds(50));
        poll();
    }
    return answered();
}

}  // namespace eti::devices
