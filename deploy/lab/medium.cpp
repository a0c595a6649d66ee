// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "deploy/lab/medium.hpp"

#include <algorithm>
#include <functional>
#include <utility>

namespace eti::lab {

namespace {

constexpr std::size_t ethernet_header = 14;  // [bytes]
// Queue of a line of limited rate before it drops frames, as a share of a second: a common router's.
constexpr std::chrono::milliseconds longest_queue{100};
// Bounds memory use if a host makes up addresses.
constexpr std::size_t most_addresses = 4096;

std::uint64_t address_at(std::span<const std::uint8_t> frame, std::size_t offset) {
    std::uint64_t address = 0;
    for (std::size_t i = 0; i < 6; ++i) {
        address = address << 8 | frame[offset + i];
    }
    return address;
}

bool is_group(std::uint64_t address) {
    return (address >> 40 & 1) != 0;
}

constexpr std::uint64_t broadcast = 0xffff'ffff'ffff;

}  // namespace

Medium::Medium(std::vector<Attachment> ports, bool multicast, std::uint64_t seed)
    : ports_(std::move(ports)),
      counts_(ports_.size()),
      up_(ports_.size()),
      down_(ports_.size()),
      multicast_(multicast),
      random_(seed) {}

void Medium::send(std::size_t port, std::span<const std::uint8_t> frame, Clock::time_point now) {
    if (frame.size() < ethernet_header) {
        return;
    }
    counts_[port].frames_sent += 1;
    counts_[port].bytes_sent += frame.size();
    const Address to = address_at(frame, 0), from = address_at(frame, 6);
    if (!is_group(from) && (where_.size() < most_addresses || where_.contains(from))) {
        where_[from] = port;
    }
    if (is_group(to) && to != broadcast && !multicast_) {
        counts_[port].held_back += 1;
        return;
    }
    const auto sent = pass(up_[port], ports_[port].rate, frame.size(), now);
    if (!sent) {
        counts_[port].overflowed += 1;
        return;
    }
    const auto shared = std::make_shared<const std::vector<std::uint8_t>>(frame.begin(), frame.end());
    const auto known = where_.find(to);
    if (!is_group(to) && known != where_.end()) {
        if (known->second != port) {
            carry(port, known->second, shared, *sent);
        }
        return;
    }
    for (std::size_t other = 0; other < ports_.size(); ++other) {
        if (other != port) {
            carry(port, other, shared, *sent);
        }
    }
}

void Medium::carry(std::size_t from, std::size_t to,
                   const std::shared_ptr<const std::vector<std::uint8_t>>& frame, Clock::time_point at) {
    const Attachment &a = ports_[from], &b = ports_[to];
    if (std::uniform_real_distribution<>()(random_) < std::max(a.loss, b.loss)) {
        counts_[to].lost += 1;
        return;
    }
    const auto jitter = std::max(a.jitter, b.jitter);
    at += std::max(a.delay, b.delay);
    if (jitter.count() > 0) {
        at +=
            std::chrono::nanoseconds(std::uniform_int_distribution<std::int64_t>(0, jitter.count())(random_));
    }
    const auto arrives = pass(down_[to], b.rate, frame->size(), at);
    if (!arrives) {
        counts_[to].overflowed += 1;
        return;
    }
    on_their_way_.push({*arrives, order_++, {to, frame}});
}

std::optional<Clock::time_point> Medium::pass(Line& line, double rate, std::size_t bytes,
                                              Clock::time_point at) const {
    if (rate <= 0.0) {
        return at;
    }
    const Clock::time_point begin = std::max(at, line.free_at);
    if (begin - at > longest_queue) {
        return std::nullopt;
    }
    line.free_at = begin + std::chrono::duration_cast<Clock::duration>(
                               std::chrono::duration<double>(8.0 * static_cast<double>(bytes) / rate));
    return line.free_at;
}

std::optional<Medium::Delivery> Medium::next(Clock::time_point now) {
    if (next_at() > now) {
        return std::nullopt;
    }
    Delivery delivery = on_their_way_.top().delivery;
    on_their_way_.pop();
    counts_[delivery.port].frames_received += 1;
    counts_[delivery.port].bytes_received += delivery.frame->size();
    return delivery;
}

Clock::time_point Medium::next_at() const {
    return on_their_way_.empty() ? Clock::time_point::max() : on_their_way_.top().at;
}

}  // namespace eti::lab
