// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/guard/admission.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/bus/library_log.hpp"

namespace eti::bus {

namespace {

// Bounds memory use on a hostile network.
constexpr std::size_t max_participants = 256, max_writers = 4096, most_news = 16;

/// Time for which a writer that was replaced this often must send to be followed again.
std::chrono::milliseconds time_to_return(unsigned replaced) {
    constexpr unsigned most_doublings = 16;
    const auto doubled =
        Admission::return_time * (1u << std::min(std::max(replaced, 1u) - 1, most_doublings));
    return std::min<std::chrono::milliseconds>(doubled, Admission::longest_return_time);
}

}  // namespace

void Admission::on_discovered(const ParticipantId& participant, const std::string& name, bool as_server) {
    const std::lock_guard lock(mutex_);
    if (!candidates_.contains(participant) && candidates_.size() >= max_participants &&
        !make_room(as_server)) {
        return;
    }
    candidates_.try_emplace(participant, Candidate{name, as_server, ++order_});
    reevaluate();
}

/// Where there are too many participants, one that is no server gives way to a server. Reported once.
bool Admission::make_room(bool for_server) {
    if (!std::exchange(crowded_, true)) {
        log(
            fmt::format("more than {} participants are in the session's domain: of the others, only servers "
                        "are listened to; "
                        "use another --domain, or end what announces itself there",
                        max_participants));
    }
    const auto other =
        std::ranges::find_if(candidates_, [](const auto& one) { return !one.second.as_server; });
    if (!for_server || other == candidates_.end()) {
        return false;
    }
    candidates_.erase(other);
    return true;
}

void Admission::on_removed(const ParticipantId& participant) {
    const std::lock_guard lock(mutex_);
    candidates_.erase(participant);
    reported_.erase(participant);
    blocked_.erase(participant);
    forget_writers(participant);
    reevaluate();
}

void Admission::on_discovered(const WriterId& writer, std::string_view topic) {
    const std::lock_guard lock(mutex_);
    const auto known = std::ranges::find(topics::all, topic, &TopicWriterPolicy::name);
    if (known == std::end(topics::all) || known->from == WriterPolicy::any) {
        return;
    }
    if (blocked_.contains(writer.participant)) {
        return;
    }
    writers_.try_emplace(writer, Writer{known->name, known->from, ++order_, false});
    set_left(writer.participant, known->name, false);
    if (writers_.size() > max_writers) {
        block_participants_over_limit();
    }
    reevaluate();
}

void Admission::on_removed(const WriterId& writer) {
    const std::lock_guard lock(mutex_);
    if (const auto known = writers_.find(writer); known != writers_.end()) {
        set_left(writer.participant, known->second.topic, true);
        writers_.erase(known);
    }
    reevaluate();
}

void Admission::on_liveliness_changed(const WriterId& writer, bool alive) {
    const std::lock_guard lock(mutex_);
    if (const auto known = writers_.find(writer); known != writers_.end()) {
        known->second.lost = !alive;
        reevaluate();
    }
}

void Admission::release_ownership(std::string_view topic) {
    const std::lock_guard lock(mutex_);
    if (const auto followed = followed_.find(topic); followed != followed_.end()) {
        Writer& writer = writers_.at(followed->second);
        writer.lost = true;
        writer.last_sample = {};
        reevaluate();
    }
}

bool Admission::rejects(const WriterId& writer, Clock::time_point now) {
    if (!any_refused_.load(std::memory_order_acquire) && !any_released_.load(std::memory_order_acquire)) {
        return false;
    }
    const std::lock_guard lock(mutex_);
    note_sample(writer, now);
    return refused_.contains(writer) || blocked_.contains(writer.participant);
}

/// A writer whose ownership was released sends again: at once it is the one to stay with; where another was
/// followed meanwhile, it gets the topic back after a while.
void Admission::note_sample(const WriterId& id, Clock::time_point now) {
    const auto known = writers_.find(id);
    if (known == writers_.end() || known->second.source != WriterPolicy::exclusive || !known->second.lost) {
        return;
    }
    Writer& writer = known->second;
    if (now - writer.last_sample > return_time) {
        writer.sends_since = now;
    }
    writer.last_sample = now;
    const auto followed = followed_.find(writer.topic);
    const bool is_followed = followed != followed_.end() && followed->second == id;
    if (is_followed || now - writer.sends_since >= time_to_return(writer.replaced)) {
        writer.lost = false;
        reevaluate();
    }
}

std::optional<ParticipantId> Admission::owner() const {
    const std::lock_guard lock(mutex_);
    return owner_;
}

bool Admission::serves(const ParticipantId& participant) const {
    const std::lock_guard lock(mutex_);
    return std::ranges::any_of(writers_, [&](const auto& writer) {
        return writer.first.participant == participant && writer.second.topic == topics::session_status.name;
    });
}

std::vector<std::string> Admission::take_log_lines() {
    const std::lock_guard lock(mutex_);
    has_log_lines_.store(false, std::memory_order_relaxed);
    return std::exchange(log_lines_, {});
}

void Admission::log_changes() {
    if (!has_log_lines_.load(std::memory_order_relaxed)) {
        return;
    }
    for (const std::string& line : take_log_lines()) {
        if (const auto suppressed = throttle_.allow(line)) {
            bus_log().warn("{}{}", line, suppressed_suffix(*suppressed));
        }
    }
}

void Admission::log(std::string line) {
    if (log_lines_.size() < most_news) {
        log_lines_.push_back(std::move(line));
        has_log_lines_.store(true, std::memory_order_relaxed);
    }
}

void Admission::forget_writers(const ParticipantId& participant) {
    std::erase_if(writers_, [&](const auto& writer) { return writer.first.participant == participant; });
}

/// The participant with the most writers is blocked to make room, so that newcomers do not suffer.
void Admission::block_participants_over_limit() {
    std::map<ParticipantId, std::size_t> counts;
    for (const auto& [id, writer] : writers_) {
        if (id.participant != owner_) {
            ++counts[id.participant];
        }
    }
    if (counts.empty()) {
        return;
    }
    const auto most = std::ranges::max_element(counts, {}, [](const auto& count) { return count.second; });
    if (blocked_.size() < max_participants) {
        blocked_.insert(most->first);
    }
    forget_writers(most->first);
}

void Admission::set_left(const ParticipantId& participant, std::string_view topic, bool left) {
    const auto candidate = candidates_.find(participant);
    if (candidate != candidates_.end() && topic == topics::session_status.name) {
        candidate->second.left = left;
    }
}

bool Admission::silent(const ParticipantId& participant) const {
    const auto candidate = candidates_.find(participant);
    const bool left = candidate != candidates_.end() && candidate->second.left;
    return left || std::ranges::any_of(writers_, [&](const auto& writer) {
               return writer.first.participant == participant && writer.second.lost;
           });
}

std::string Admission::name_of(const ParticipantId& participant) const {
    const auto known = candidates_.find(participant);
    return known != candidates_.end() && !known->second.name.empty() ? known->second.name
                                                                     : "an anonymous participant";
}

void Admission::choose_owner() {
    if (self_) {
        return;
    }
    if (owner_ && candidates_.contains(*owner_) && !silent(*owner_)) {
        return;
    }
    const Candidate* best = nullptr;
    std::optional<ParticipantId> chosen;
    for (const auto& [id, candidate] : candidates_) {
        if (candidate.as_server && !silent(id) && (best == nullptr || candidate.order < best->order)) {
            best = &candidate;
            chosen = id;
        }
    }
    // A silent owner may return; it stays the owner until there is another candidate or it leaves.
    if (chosen || (owner_ && !candidates_.contains(*owner_))) {
        owner_ = chosen;
    }
}

bool Admission::may_write(const WriterId& id, const Writer& writer) const {
    if (writer.source == WriterPolicy::exclusive) {
        const auto followed = followed_.find(writer.topic);
        return followed == followed_.end() || followed->second == id;
    }
    if (self_) {
        return false;
    }
    const auto candidate = candidates_.find(id.participant);
    const bool introduced = candidate != candidates_.end() && candidate->second.as_server;
    return owner_ ? id.participant == *owner_ : introduced;
}

/// From now on this writer of an exclusive topic is followed.
void Admission::follow(const WriterId& id, const Writer& writer) {
    const auto [entry, first] = followed_.try_emplace(writer.topic, id);
    if (first) {
        return;
    }
    const WriterId before = std::exchange(entry->second, id);
    Writer& replaced = writers_.at(before);
    if (writer.order < replaced.order) {
        if (writer.lost) {
            return;  // both are silent: the first is the one to wait for
        }
        log(fmt::format("{} sends {} again and is followed again, instead of {}", name_of(id.participant),
                        writer.topic, name_of(before.participant)));
        return;
    }
    ++replaced.replaced;
    log(fmt::format("{} has stopped sending {}: {} is followed until it is back", name_of(before.participant),
                    writer.topic, name_of(id.participant)));
}

/// Recomputes which participant owns the session, which writers are followed and which are rejected.
void Admission::reevaluate() {
    choose_owner();
    std::erase_if(followed_, [&](const auto& entry) { return !writers_.contains(entry.second); });
    for (const auto& [id, writer] : writers_) {
        if (writer.source != WriterPolicy::exclusive) {
            continue;
        }
        const auto followed = followed_.find(writer.topic);
        const auto rank = [](const Writer& one) { return std::pair(one.lost, one.order); };
        if (followed == followed_.end() || rank(writer) < rank(writers_.at(followed->second))) {
            follow(id, writer);
        }
    }
    any_released_.store(
        std::ranges::any_of(
            writers_,
            [](const auto& one) { return one.second.source == WriterPolicy::exclusive && one.second.lost; }),
        std::memory_order_release);

    std::set<WriterId> refused;
    std::optional<ParticipantId> second;
    for (const auto& [id, writer] : writers_) {
        if (may_write(id, writer)) {
            continue;
        }
        refused.insert(id);
        // A server that has fallen silent was killed; it does not contest the session.
        const bool contests =
            writer.topic == topics::session_status.name && !writer.lost && (owner_ || self_);
        if (contests) {
            second = id.participant;
        } else if (candidates_.contains(id.participant) && !writer.lost && log_lines_.size() < most_news &&
                   writer.replaced == 0 && reported_.insert(id.participant).second) {
            log(fmt::format("{} writes {}, which is {}: ignored", name_of(id.participant), writer.topic,
                            writer.source == WriterPolicy::exclusive
                                ? "reserved for another writer while that one is active"
                                : "reserved for the server"));
        }
    }
    if (second.has_value() != contested_.load()) {
        log(second ? fmt::format("{} writes this session's status in addition to its server{}: it is "
                                 "ignored, and forces are off until it has left",
                                 name_of(*second), owner_ ? fmt::format(" {}", name_of(*owner_)) : "")
                   : "the session has one server again");
    }
    contested_.store(second.has_value(), std::memory_order_relaxed);
    refused_ = std::move(refused);
    any_refused_.store(!refused_.empty() || !blocked_.empty(), std::memory_order_release);
}

}  // namespace eti::bus
