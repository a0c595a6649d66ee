// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <deque>

#include "common/math/random.hpp"

namespace eti::validation {

/// The connection between device and server; half of the delay each way.
struct Channel {
    double delay = 0.0;   ///< [s], round trip
    double jitter = 0.0;  ///< [s], maximum extra delay of a message, each way, uniformly distributed
    double loss = 0.0;    ///< share of messages lost, each way
};

/// Messages in transit, one way.
template <class Message>
struct Line {
    struct Sent {
        std::int64_t arrives;
        Message message;
    };
    std::deque<Sent> on_the_way;

    void send(const Message& message, std::int64_t now, const Channel& channel, Random& random) {
        if (static_cast<double>(random.uniform()) < channel.loss) {
            return;
        }
        const double late = 0.5 * channel.delay + channel.jitter * static_cast<double>(random.uniform());
        on_the_way.push_back({now + static_cast<std::int64_t>(1e9 * late), message});
    }
    /// The newest message that has arrived; an overtaken one is dropped, as with KEEP_LAST.
    bool receive(std::int64_t now, Message& message) {
        bool any = false;
        std::int64_t newest = 0;
        std::erase_if(on_the_way, [&](const Sent& sent) {
            if (sent.arrives > now) {
                return false;
            }
            if (sent.arrives >= newest) {
                newest = sent.arrives;
                message = sent.message;
                any = true;
            }
            return true;
        });
        return any;
    }
};

}  // namespace eti::validation
