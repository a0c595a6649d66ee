// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/commands/command_queue.hpp"

#include <algorithm>
#include <utility>

namespace eti::app {

bool SenderRateLimiter::try_acquire(const bus::ParticipantId& from, RateLimiter::Clock::time_point now) {
    const bool fits = senders_.contains(from) || senders_.size() < max_senders;
    return senders_.try_emplace(fits ? from : bus::ParticipantId{}, per_second_)
        .first->second.try_acquire(now);
}

bool CommandQueue::put(const bus::ParticipantId& from, ReceivedCommand command) {
    if (!senders_.contains(from) && senders_.size() >= max_senders) {
        // A sender without pending commands loses only its rate limiter's state.
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
        if (sender.by_kind.size() >= max_kinds) {
            ++sender.replaced_count;
            return false;
        }
        std::string kind = command.name;
        sender.by_kind.emplace(std::move(kind), Waiting{std::move(command), ++order_});
        return true;
    }
    ++sender.replaced_count;
    ReceivedCommand replaced = std::exchange(known->second.command, std::move(command));
    if (sender.replaced.size() < max_kinds) {
        sender.replaced.push_back(std::move(replaced));
    }
    return true;
}

std::vector<ReceivedCommand> CommandQueue::take_due(Clock::time_point now) {
    std::vector<Waiting> due;
    for (auto& [id, sender] : senders_) {
        while (!sender.by_kind.empty() && sender.allowed.try_acquire(now)) {
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
            if (sender.answered.try_acquire(now)) {
                out.push_back(std::move(command));
            }
        }
        sender.replaced.clear();
    }
    return out;
}

std::uint64_t CommandQueue::take_replaced_count(std::string& name) {
    std::uint64_t sum = 0, most = 0;
    for (auto& [id, sender] : senders_) {
        sum += sender.replaced_count;
        if (sender.replaced_count > most && !sender.by_kind.empty()) {
            most = sender.replaced_count;
            name = sender.by_kind.begin()->second.command.sender;
        }
        sender.replaced_count = 0;
    }
    return sum;
}

}  // namespace eti::app
