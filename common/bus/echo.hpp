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
#include "common/process/rate_limiter.hpp"

namespace eti::bus {

/// Answers the session's echo requests on its own thread, at most two hundred a second.
class EchoResponder {
  public:
    EchoResponder(std::shared_ptr<Participant> participant, std::string program);
    ~EchoResponder();
    EchoResponder(const EchoResponder&) = delete;
    EchoResponder& operator=(const EchoResponder&) = delete;

  private:
    void run();
    void answer(const msg::Echo& question);

    std::string program_;
    WaitSet wait_set_;
    Subscriber<msg::Echo> questions_;
    Publisher<msg::Echo> answers_;
    RateLimiter allowed_{200.0};
    std::atomic<bool> ending_{false};
    std::thread thread_;
};

/// Message round trips to a peer, and the offset of its clock.
struct PeerEcho {
    std::string process;  ///< host:pid of the peer
    std::string program;  ///< its name
    std::size_t answers = 0;
    double round_trip_ms = 0.0;  ///< the latest
    double min_round_trip_ms = 0.0;
    /// Peer's clock minus this one's, from the fastest answer (RFC 5905, section 8). The error is at most
    /// half of its round trip, reached when the delays of the two directions differ.
    double clock_offset_ms = 0.0;
    std::vector<double> round_trips_ms;  ///< the last thousand
};

/// Sends echo requests to all peers and collects their answers; use from one thread.
class EchoRequester {
  public:
    explicit EchoRequester(Node& node);

    /// Sends a request; false: no peer receives it.
    bool ask();
    /// Processes the answers received since the last call.
    void poll();
    /// Keyed by process.
    [[nodiscard]] const std::map<std::string, PeerEcho>& peers() const { return peers_; }
    [[nodiscard]] std::uint64_t asked() const { return asked_; }

  private:
    static constexpr std::size_t max_peers = 256;

    Publisher<msg::Echo> questions_;
    Subscriber<msg::Echo> answers_;
    std::uint64_t nonce_, asked_ = 0;
    msg::Echo message_;
    std::map<std::string, PeerEcho> peers_;
};

}  // namespace eti::bus
