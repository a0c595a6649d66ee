// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/command_sender.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include "common/bus/codec/convert.hpp"

namespace eti::bus {
namespace {

// The topic's history depth: older commands were never answered.
constexpr std::size_t max_pending = 64;

}  // namespace

CommandSender::CommandSender(Node& node, std::string_view program)
    : sender_(fmt::format("{}:{}", program, ::getpid())),
      commands_(node, topics::command),
      answers_(node, topics::command_result) {}

bool CommandSender::send(std::string_view name, float value) {
    if (!has_server()) {
        return false;
    }
    msg::Command message;
    message.header(make_header(0, sent_ + 1));
    message.sender(sender_);
    message.id(sent_ + 1);
    message.name(std::string(name));
    message.value(value);
    if (!commands_.publish(message)) {
        return false;
    }
    pending_[++sent_] = name;
    if (pending_.size() > max_pending) {
        pending_.erase(pending_.begin());
    }
    return true;
}

std::vector<Refusal> CommandSender::take_answers() {
    std::vector<Refusal> refusals;
    msg::CommandResult answer;
    while (answers_.take(answer)) {
        const auto asked = pending_.find(answer.id());
        if (answer.recipient().to_string() != sender_ || asked == pending_.end()) {
            continue;
        }
        ++(answer.accepted() ? accepted_ : refused_);
        if (!answer.accepted()) {
            refusals.push_back({asked->second, answer.reason().to_string()});
            spdlog::warn("{} refused: {}", refusals.back().name, refusals.back().reason);
        }
        pending_.erase(asked);
    }
    return refusals;
}

}  // namespace eti::bus
