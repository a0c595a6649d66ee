// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/rtps_message.hpp"

namespace eti::bus {

/// Whom a participant listens to. A session has one owner: the participant that introduces itself as its
/// server and was found first. What is the server's to write is taken from the owner alone; a topic of one
/// writer from the one that was found first, until it is let go. A second writer of SessionStatus makes the
/// session contested. Told by discovery what there is; asked by the receive filter, on whatever thread. This
/// keeps out who does not know better or does not introduce itself; who imitates a server in everything is
/// kept out by certificates alone.
class Admission {
  public:
    /// `self`: this participant is the session's server.
    explicit Admission(bool self) : self_(self) {}

    /// `name`: for people. `as_server`: introduces itself as this session's server.
    void found(const ParticipantId& participant, const std::string& name, bool as_server);
    void gone(const ParticipantId& participant);
    /// A writer of one of topics::all, in this session.
    void found(const WriterId& writer, std::string_view topic);
    void gone(const WriterId& writer);
    /// Liveliness of a writer of SessionStatus.
    void heard(const WriterId& writer, bool alive);
    /// Whoever writes this topic of one writer is followed only until there is another.
    void let_go(std::string_view topic);

    [[nodiscard]] bool refuses(const WriterId& writer) const;
    [[nodiscard]] std::optional<ParticipantId> owner() const;
    /// It writes this session's SessionStatus.
    [[nodiscard]] bool serves(const ParticipantId& participant) const;
    [[nodiscard]] bool contested() const { return contested_.load(std::memory_order_relaxed); }
    /// What has changed since last asked, in lines for people.
    [[nodiscard]] std::vector<std::string> news();

  private:
    struct Candidate {
        std::string name;
        bool as_server = false;
        std::uint64_t order = 0;  // in which it was found
    };
    struct Writer {
        std::string_view topic;
        Source source = Source::anybody;
        std::uint64_t order = 0;
        bool lost = false;  // was alive, and is no more; or was let go
    };

    void judge();
    void forget_writers(const ParticipantId& participant);
    void shut_out_most();
    void choose_owner();
    [[nodiscard]] bool may_write(const WriterId& id, const Writer& writer) const;
    [[nodiscard]] bool silent(const ParticipantId& participant) const;
    [[nodiscard]] std::string name_of(const ParticipantId& participant) const;

    const bool self_;
    mutable std::mutex mutex_;
    std::map<ParticipantId, Candidate> candidates_;
    std::map<WriterId, Writer> writers_;
    std::map<std::string_view, WriterId> followed_;  // of topics of one writer
    std::optional<ParticipantId> owner_;
    std::set<WriterId> refused_;
    std::set<ParticipantId> shut_out_;  // for more writers than there is room for
    std::set<ParticipantId> told_;      // of refused ones a line was written
    std::vector<std::string> news_;
    std::uint64_t order_ = 0;
    std::atomic<bool> any_refused_{false}, contested_{false};
};

}  // namespace eti::bus
