// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/topics.hpp"

namespace eti::bus {

struct Options {
    std::string session = "default";   ///< several share a domain
    int domain = 0;                    ///< DDS domain, 0-232
    std::string name{};                ///< of this participant, e.g. "eti-server"
    std::filesystem::path profile{};   ///< optional XML profile file (transports, peers)
    std::vector<std::string> peers{};  ///< other machines, by name or address; empty: by multicast
    bool network = false;              ///< other machines are looked for; else this one alone
    std::vector<std::string>
        discovery_servers{};  ///< HOST or HOST:PORT; the second is the first one's backup
    bool one_of_many =
        false;  ///< shares what is sent to several alike by multicast, where there is multicast
    std::filesystem::path identity{};  ///< folder of certificate and permissions; empty: no security
};

/// Something about the bus that a person can mend; the text says what to do.
class BusError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Tells participants apart; the library's own.
using ParticipantId = std::array<std::uint8_t, 12>;

/// Options::name of the server, by which the others know it while it is still loading.
inline constexpr std::string_view server_name = "eti-server";

/// "host:pid" of this process, as SessionStatus names a server; at most 64 characters.
[[nodiscard]] std::string process_name();

class Participant;

/// A process's place on the bus: participant, publisher and subscriber in the session's partition.
/// Throws BusError from the constructor.
class Node {
  public:
    explicit Node(const Options& options);
    ~Node();
    Node(const Node&) = delete;
    Node& operator=(const Node&) = delete;
    struct Impl;
    [[nodiscard]] Impl& impl() const { return *impl_; }
    [[nodiscard]] const Options& options() const;
    /// A second participant writes this session's status beside its owner: nobody's forces are to be
    /// believed.
    [[nodiscard]] bool contested() const;

  private:
    std::unique_ptr<Impl> impl_;
};

/// Writes one topic, for one thread. publish() never blocks longer than the topic's QoS allows; false: not
/// written (the message breaks a bound of the IDL, or a reliable reader is stuck).
template <class Message>
class Publisher {
  public:
    Publisher(Node& node, const Topic<Message>& topic);
    Publisher(std::shared_ptr<Participant> participant, const Topic<Message>& topic);
    ~Publisher();
    Publisher(Publisher&&) noexcept;
    bool publish(const Message& message);
    [[nodiscard]] int matched() const;  ///< readers now matched
    void assert_liveliness();           ///< for topics with manual liveliness
    /// Waits until every reliable reader has acknowledged all that was published, at most `timeout`; true
    /// if they have. A writer that goes earlier takes with it what was not delivered.
    bool wait_until_received(std::chrono::milliseconds timeout);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Rings when a sample has come to one of the subscribers that ring it: for a thread that serves several
/// topics. Has to outlive them.
class Bell {
  public:
    Bell();
    ~Bell();
    Bell(const Bell&) = delete;
    Bell& operator=(const Bell&) = delete;
    /// Waits until it has rung since the last call; false: it has not within `timeout`.
    [[nodiscard]] bool wait(std::chrono::milliseconds timeout);
    struct Impl;
    [[nodiscard]] Impl& impl() const { return *impl_; }

  private:
    std::unique_ptr<Impl> impl_;
};

/// Reads one topic, for one thread. Samples wait in the reader's bounded history until taken; nothing is
/// called back on a DDS thread, so message handling stays on the caller's thread.
template <class Message>
class Subscriber {
  public:
    Subscriber(Node& node, const Topic<Message>& topic);
    Subscriber(std::shared_ptr<Participant> participant, const Topic<Message>& topic);
    ~Subscriber();
    Subscriber(Subscriber&&) noexcept;
    /// Oldest sample not yet taken; never blocks. `message` is reused to spare allocations;
    /// unspecified on false. A malformed sample is dropped, never thrown.
    [[nodiscard]] bool take(Message& message);
    /// Newest sample not yet taken, of whatever key, dropping older ones; never blocks. `message` is
    /// left as it was on false.
    [[nodiscard]] bool take_latest(Message& message);
    /// Waits until there is something to take.
    [[nodiscard]] bool wait(std::chrono::milliseconds timeout);
    void ring(Bell& bell);  ///< at every sample from now on
    /// Who sent what was taken last.
    [[nodiscard]] const ParticipantId& sender() const;
    /// When what was taken last came to this process [ns, its system clock], however late it was taken.
    [[nodiscard]] std::uint64_t received_ns() const;
    /// Of a topic with one writer at a time: this one is followed no more, because it is silent.
    void let_go();
    [[nodiscard]] int matched() const;  ///< writers now matched
    [[nodiscard]] bool alive() const;   ///< some writer is matched and, where liveliness is asked for, alive

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Throws BusError, with both versions, while the session's server speaks another protocol: for whoever waits
/// for a server, which would else not be found.
void refuse_other_protocol(const Node& node);

/// Where a server was looked for in vain, and what to do.
struct Absence {
    std::string finding, remedy;
};
[[nodiscard]] Absence absence_of_server(const Options& options);

/// Both in one line, for whoever waits for one.
[[nodiscard]] std::string no_server(const Options& options);

/// What the start-up check found, one line each, with the remedy; empty when all is well.
struct SelfCheck {
    std::vector<std::string> warnings;
};

/// Looks for stale shared memory of dead processes, an unusable network, a taken session; a server
/// calls it before it publishes SessionStatus. Takes all of `wait` for a server; for others, until a
/// server is found. `is_server`: refuses (BusError) when another live server owns the session, or
/// started on it first. Others refuse when the session's server speaks another protocol.
[[nodiscard]] SelfCheck self_check(Node& node, bool is_server, std::chrono::milliseconds wait);

}  // namespace eti::bus
