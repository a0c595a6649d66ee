// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <queue>
#include <random>
#include <span>
#include <unordered_map>
#include <vector>

namespace eti::lab {

using Clock = std::chrono::steady_clock;

/// A host's connection to the medium. Between two hosts, the worse value of the two counts.
struct Attachment {
    std::chrono::nanoseconds delay{0};   ///< one way
    std::chrono::nanoseconds jitter{0};  ///< uniform, up to this; frames may then overtake each other
    double loss = 0.0;                   ///< independent loss probability of a frame
    double rate = 0.0;                   ///< [bit/s] each way; 0: no limit
};

/// Statistics of a host's port.
struct PortCount {
    std::uint64_t frames_sent = 0, bytes_sent = 0;          ///< by the host
    std::uint64_t frames_received = 0, bytes_received = 0;  ///< by the host
    std::uint64_t lost = 0;                                 ///< on the way to it, at random
    std::uint64_t overflowed = 0;                           ///< from or to it: its rate's queue was full
    std::uint64_t held_back = 0;  ///< multicast from it that the medium does not carry
};

/// A learning switch with delay, loss and limited rate between its ports. Independent of sockets and clock.
class Medium {
  public:
    /// `multicast`: whether it is carried, to every other host; broadcast always is, since hosts need it to
    /// find each other.
    Medium(std::vector<Attachment> ports, bool multicast, std::uint64_t seed);

    /// Sends a host's frame (Ethernet, without checksum).
    void send(std::size_t port, std::span<const std::uint8_t> frame, Clock::time_point now);

    struct Delivery {
        std::size_t port;
        std::shared_ptr<const std::vector<std::uint8_t>> frame;
    };
    /// The next frame that has arrived by `now`, counted as received.
    [[nodiscard]] std::optional<Delivery> next(Clock::time_point now);
    /// Arrival time of the next frame; Clock::time_point::max() if there is none.
    [[nodiscard]] Clock::time_point next_at() const;

    [[nodiscard]] const std::vector<PortCount>& counts() const { return counts_; }

  private:
    using Address = std::uint64_t;

    struct OnItsWay {
        Clock::time_point at;
        std::uint64_t order;  ///< ties: frames with equal arrival times keep their order
        Delivery delivery;
        bool operator>(const OnItsWay& other) const {
            return at != other.at ? at > other.at : order > other.order;
        }
    };
    /// When a line of limited rate was last busy.
    struct Line {
        Clock::time_point free_at = Clock::time_point::min();
    };

    void carry(std::size_t from, std::size_t to,
               const std::shared_ptr<const std::vector<std::uint8_t>>& frame, Clock::time_point at);
    [[nodiscard]] std::optional<Clock::time_point> pass(Line& line, double rate, std::size_t bytes,
                                                        Clock::time_point at) const;

    std::vector<Attachment> ports_;
    std::vector<PortCount> counts_;
    std::vector<Line> up_, down_;
    bool multicast_;
    std::mt19937_64 random_;
    std::unordered_map<Address, std::size_t> where_;
    std::priority_queue<OnItsWay, std::vector<OnItsWay>, std::greater<>> on_their_way_;
    std::uint64_t order_ = 0;
};

}  // namespace eti::lab
