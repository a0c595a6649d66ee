// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/process/allowance.hpp"

namespace eti::bus {

/// Answers every question of the session, two hundred a second at most, on a thread of its own.
class EchoAnswers {
  public:
    EchoAnswers(std::shared_ptr<Participant> participant, std::string program);
    ~EchoAnswers();
    EchoAnswers(const EchoAnswers&) = delete;
    EchoAnswers& operator=(const EchoAnswers&) = delete;

  private:
    void run();
    void answer(const msg::Echo& question);

    std::string program_;
    Bell bell_;
    Subscriber<msg::Echo> questions_;
    Publisher<msg::Echo> answers_;
    Allowance allowed_{200.0};
    std::atomic<bool> ending_{false};
    std::thread thread_;
};

/// How long messages take to a peer, and how its clock lies to this one's.
struct PeerEcho {
    std::string process;  ///< host:pid of the peer
    std::string program;  ///< its name
    std::size_t answers = 0;
    double round_trip_ms = 0.0;  ///< the last one's
    double least_round_trip_ms = 0.0;
    /// Peer's clock minus this one's, by the fastest answer (RFC 5905, section 8); off by half of its round
    /// trip at most, where the ways there and back take different times.
    double clock_offset_ms = 0.0;
    std::vector<double> round_trips_ms;  ///< the last thousand
};

/// Asks whoever hears it, and keeps what the peers answered. For one thread.
class EchoAsker {
  public:
    explicit EchoAsker(Node& node);

    /// Sends a question; false: nobody hears it.
    bool ask();
    /// Takes in what was answered since.
    void poll();
    /// By process.
    [[nodiscard]] const std::map<std::string, PeerEcho>& peers() const { return peers_; }
    [[nodiscard]] std::uint64_t asked() const { return asked_; }

  private:
    static constexpr std::size_t most_peers = 256;

    Publisher<msg::Echo> questions_;
    Subscriber<msg::Echo> answers_;
    std::uint64_t nonce_, asked_ = 0;
    msg::Echo message_;
    std::map<std::string, PeerEcho> peers_;
};

}  // namespace eti::bus
