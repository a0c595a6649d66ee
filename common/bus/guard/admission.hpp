// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/guard/rtps_message.hpp"
#include "common/process/log_throttle.hpp"

namespace eti::bus {

/// Decides from which writers a participant accepts samples. A session has one owner: the first discovered
/// participant that identifies itself as its server. Server topics are accepted from the owner alone; an
/// exclusive topic from the writer discovered first; while that one's ownership is released, from the next
/// one. The first gets the topic back once it has sent again without a break. A second writer of
/// SessionStatus makes the session contested. Discovery reports participants and writers; the receive filter
/// queries from any thread. This stops misconfigured programs and those that do not identify themselves. Only
/// certificates stop a program that imitates a server completely.
class Admission {
  public:
    using Clock = std::chrono::steady_clock;
    /// For which a returning writer of an exclusive topic must send, without a longer break, to get it back;
    /// twice as long each time, up to the longest, so that an unsteady device does not take turns with
    /// another.
    static constexpr std::chrono::milliseconds return_time{200};
    static constexpr std::chrono::seconds longest_return_time{60};

    /// `self`: this participant is the session's server.
    explicit Admission(bool self) : self_(self) {}

    /// `name`: for log lines. `as_server`: identifies itself as this session's server.
    void on_discovered(const ParticipantId& participant, const std::string& name, bool as_server);
    void on_removed(const ParticipantId& participant);
    /// A writer of one of topics::all, in this session.
    void on_discovered(const WriterId& writer, std::string_view topic);
    void on_removed(const WriterId& writer);
    /// Liveliness of a writer of SessionStatus.
    void on_liveliness_changed(const WriterId& writer, bool alive);
    /// The current writer of this exclusive topic is followed only until there is another, or until it sends
    /// again.
    void release_ownership(std::string_view topic);

    /// Whether a sample of this writer, which has just arrived, is rejected.
    [[nodiscard]] bool rejects(const WriterId& writer, Clock::time_point now = Clock::now());
    [[nodiscard]] std::optional<ParticipantId> owner() const;
    /// Whether it writes this session's SessionStatus.
    [[nodiscard]] bool serves(const ParticipantId& participant) const;
    [[nodiscard]] bool contested() const { return contested_.load(std::memory_order_relaxed); }
    /// Changes since the last call, as log lines.
    [[nodiscard]] std::vector<std::string> take_log_lines();
    /// Logs those lines as warnings, each at most once a second. Takes no lock if there are none.
    void log_changes();

  private:
    struct Candidate {
        std::string name;
        bool as_server = false;
        std::uint64_t order = 0;  // order of discovery
        bool left = false;  // its writer of SessionStatus was removed; the rest follows within its lease
    };
    struct Writer {
        std::string_view topic;
        WriterPolicy source = WriterPolicy::any;
        std::uint64_t order = 0;
        bool lost = false;  // not alive any more, or ownership released
        // Of an exclusive topic, once its ownership was released:
        unsigned replaced = 0;            // times that another writer was followed instead
        Clock::time_point sends_since{};  // without a break
        Clock::time_point last_sample{};
    };

    [[nodiscard]] bool make_room(bool for_server);
    void reevaluate();
    void follow(const WriterId& id, const Writer& writer);
    void note_sample(const WriterId& id, Clock::time_point now);
    void log(std::string line);
    void forget_writers(const ParticipantId& participant);
    void block_participants_over_limit();
    void choose_owner();
    [[nodiscard]] bool may_write(const WriterId& id, const Writer& writer) const;
    void set_left(const ParticipantId& participant, std::string_view topic, bool left);
    [[nodiscard]] bool silent(const ParticipantId& participant) const;
    [[nodiscard]] std::string name_of(const ParticipantId& participant) const;

    const bool self_;
    mutable std::mutex mutex_;
    std::map<ParticipantId, Candidate> candidates_;
    std::map<WriterId, Writer> writers_;
    std::map<std::string_view, WriterId> followed_;  // of exclusive topics
    std::optional<ParticipantId> owner_;
    std::set<WriterId> refused_;
    std::set<ParticipantId> blocked_;   // over the limit of writers
    std::set<ParticipantId> reported_;  // rejected ones already logged
    std::vector<std::string> log_lines_;
    LogThrottle throttle_;
    bool crowded_ = false;  // too many participants: reported
    std::uint64_t order_ = 0;
    std::atomic<bool> any_refused_{false}, contested_{false}, has_log_lines_{false};
    std::atomic<bool> any_released_{false};  // an exclusive topic's writer has lost its ownership
};

}  // namespace eti::bus
