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
    std::string session = "default";   ///< several sessions can share a domain
    int domain = 0;                    ///< DDS domain, 0-232
    std::string name{};                ///< of this participant, e.g. "eti-server"
    std::filesystem::path profile{};   ///< optional XML profile file (transports, peers)
    std::vector<std::string> peers{};  ///< other hosts, by name or address; empty: multicast discovery
    bool network = false;              ///< discover participants on other hosts; else on this host alone
    std::vector<std::string>
        discovery_servers{};   ///< HOST or HOST:PORT; the second is the first one's backup
    std::string interface {};  ///< the only network interface to use, by name or address; empty: all
    bool shared_multicast =
        false;  ///< sends one copy to all readers of a topic by multicast, where that is available
    std::filesystem::path identity{};  ///< folder of certificate and permissions; empty: no security
};

/// A bus error that the user can fix; the text states the remedy.
class BusError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The DDS library's participant identifier (GUID prefix).
using ParticipantId = std::array<std::uint8_t, 12>;

/// Options::name of the server; participants recognise it by this name even while it is loading.
inline constexpr std::string_view server_name = "eti-server";

/// "host:pid" of this process, as SessionStatus names a server; at most 64 characters.
[[nodiscard]] std::string process_name();

class Participant;

/// A process's DDS entities: participant, publisher and subscriber in the session's partition. The
/// constructor throws BusError.
class Node {
  public:
    explicit Node(const Options& options);
    ~Node();
    Node(const Node&) = delete;
    Node& operator=(const Node&) = delete;
    struct Impl;
    [[nodiscard]] Impl& impl() const { return *impl_; }
    [[nodiscard]] const Options& options() const;
    /// True while a second participant publishes this session's status. Forces must not be rendered then.
    [[nodiscard]] bool contested() const;

  private:
    std::unique_ptr<Impl> impl_;
};

/// Publishes one topic; use from one thread. publish() blocks no longer than the topic's QoS allows. It
/// returns false if the sample was not written: it exceeds a bound of the IDL, or a reliable reader is stuck.
template <class Message>
class Publisher {
  public:
    Publisher(Node& node, const Topic<Message>& topic);
    Publisher(std::shared_ptr<Participant> participant, const Topic<Message>& topic);
    ~Publisher();
    Publisher(Publisher&&) noexcept;
    bool publish(const Message& message);
    [[nodiscard]] int matched() const;  ///< number of matched readers
    void assert_liveliness();           ///< for topics with manual liveliness
    /// Waits up to `timeout` until every reliable reader has acknowledged all samples; true if they have.
    /// Destroying the publisher earlier discards undelivered samples.
    bool wait_until_received(std::chrono::milliseconds timeout);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Signals that a sample has arrived at one of the attached subscribers, for a thread that serves several
/// topics. Must outlive the subscribers.
class WaitSet {
  public:
    WaitSet();
    ~WaitSet();
    WaitSet(const WaitSet&) = delete;
    WaitSet& operator=(const WaitSet&) = delete;
    /// Waits until signalled since the last call; false on timeout.
    [[nodiscard]] bool wait(std::chrono::milliseconds timeout);
    struct Impl;
    [[nodiscard]] Impl& impl() const { return *impl_; }

  private:
    std::unique_ptr<Impl> impl_;
};

/// Reads one topic; use from one thread. Samples stay in the reader's bounded history until taken. No
/// callback runs on a DDS thread, so message handling stays on the caller's thread.
template <class Message>
class Subscriber {
  public:
    Subscriber(Node& node, const Topic<Message>& topic);
    Subscriber(std::shared_ptr<Participant> participant, const Topic<Message>& topic);
    ~Subscriber();
    Subscriber(Subscriber&&) noexcept;
    /// Takes the oldest sample; never blocks. `message` is reused to save allocations and unspecified on
    /// false. A malformed sample is dropped, never thrown.
    [[nodiscard]] bool take(Message& message);
    /// Takes the newest sample of any key and drops older ones; never blocks. `message` is unchanged on
    /// false.
    [[nodiscard]] bool take_latest(Message& message);
    /// Waits until a sample can be taken.
    [[nodiscard]] bool wait(std::chrono::milliseconds timeout);
    void notify(WaitSet& wait_set);  ///< at every sample from now on
    /// Sender of the last sample taken.
    [[nodiscard]] const ParticipantId& sender() const;
    /// Reception time of the last sample taken [ns, this process's system clock], however late it was taken.
    [[nodiscard]] std::uint64_t received_ns() const;
    /// For a topic with exclusive ownership: stops following the current writer, because it is silent.
    void release_ownership();
    [[nodiscard]] int matched() const;  ///< number of matched writers
    [[nodiscard]] bool alive() const;   ///< a writer is matched and, where liveliness is used, alive

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Throws BusError with both versions if the session's server speaks another protocol. Call it while waiting
/// for a server, which would otherwise never be found.
void refuse_other_protocol(const Node& node);

/// Where discovery looked for a server, and the remedy.
struct DiscoveryTimeout {
    std::string finding, remedy;
};
[[nodiscard]] DiscoveryTimeout explain_missing_server(const Options& options);

/// Both in one line, for a program that waits for a server.
[[nodiscard]] std::string missing_server_message(const Options& options);

/// Findings of the start-up check, one line each, with the remedy; empty when there is no problem.
struct SelfCheck {
    std::vector<std::string> warnings;
};

/// Looks for stale shared memory of dead processes, an unusable network and an occupied session. A server
/// calls it before it publishes SessionStatus and waits the full `wait` for other servers; other programs
/// wait until a server is found. A server (`is_server`) throws BusError when another live server owns the
/// session or started on it first. Other programs throw BusError when the session's server speaks another
/// protocol.
[[nodiscard]] SelfCheck self_check(Node& node, bool is_server, std::chrono::milliseconds wait);

}  // namespace eti::bus
