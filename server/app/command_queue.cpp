// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/command_queue.hpp"

#include <algorithm>
#include <utility>

namespace eti::app {

bool Allowance::take(Clock::time_point now) {
    if (last_ != Clock::time_point{}) {
        left_ =
            std::min(per_second_, left_ + per_second_ * std::chrono::duration<double>(now - last_).count());
    }
    last_ = now;
    if (left_ < 1.0) {
        return false;
    }
    left_ -= 1.0;
    return true;
}

bool SenderAllowance::take(const bus::ParticipantId& from, Allowance::Clock::time_point now) {
    const bool fits = senders_.contains(from) || senders_.size() < most_senders;
    return senders_.try_emplace(fits ? from : bus::ParticipantId{}, per_second_).first->second.take(now);
}

bool CommandQueue::put(const bus::ParticipantId& from, ReceivedCommand command) {
    if (!senders_.contains(from) && senders_.size() >= most_senders) {
        // Who has nothing waiting has nothing to lose but an allowance.
        const auto idle =
            std::ranges::find_if(senders_, [](const auto& sender) { return sender.second.by_kind.empty(); });
        if (idle == senders_.end()) {
            return false;
        }
        senders_.erase(idle);
    }
    Sender& sender = senders_[from];
    const auto known = sender.by_kind.find(command.name);
    if (known == sender.by_kind.end()) {
        if (sender.by_kind.size() >= most_kinds) {
            ++sender.flood;
            return false;
        }
        std::string kind = command.name;
        sender.by_kind.emplace(std::move(kind), Waiting{std::move(command), ++order_});
        return true;
    }
    ++sender.flood;
    ReceivedCommand replaced = std::exchange(known->second.command, std::move(command));
    if (sender.replaced.size() < most_kinds) {
        sender.replaced.push_back(std::move(replaced));
    }
    return true;
}

std::vector<ReceivedCommand> CommandQueue::take_due(Clock::time_point now) {
    std::vector<Waiting> due;
    for (auto& [id, sender] : senders_) {
        while (!sender.by_kind.empty() && sender.allowed.take(now)) {
            const auto first = std::ranges::min_element(sender.by_kind, {},
                                                        [](const auto& kind) { return kind.second.order; });
            due.push_back(std::move(first->second));
            sender.by_kind.erase(first);
        }
    }
    std::ranges::sort(due, {}, &Waiting::order);
    std::vector<ReceivedCommand> out;
    for (Waiting& waiting : due) {
        out.push_back(std::move(waiting.command));
    }
    return out;
}

std::vector<ReceivedCommand> CommandQueue::take_replaced(Clock::time_point now) {
    std::vector<ReceivedCommand> out;
    for (auto& [id, sender] : senders_) {
        for (ReceivedCommand& command : sender.replaced) {
            if (sender.answered.take(now)) {
                out.push_back(std::move(command));
            }
        }
        sender.replaced.clear();
    }
    return out;
}

std::uint64_t CommandQueue::take_flood(std::string& name) {
    std::uint64_t sum = 0, most = 0;
    for (auto& [id, sender] : senders_) {
        sum += sender.flood;
        if (sender.flood > most && !sender.by_kind.empty()) {
            most = sender.flood;
            name = sender.by_kind.begin()->second.command.sender;
        }
        sender.flood = 0;
    }
    return sum;
}

}  // namespace eti::app
