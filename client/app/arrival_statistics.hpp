// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cstdint>

#include "common/model/pace.hpp"
#include "idl/eti_wire.hpp"

namespace eti::client {

/// Message age and number of missed states of one topic. Ages compare the clocks of two machines: they are
/// meaningful only if both share a clock or are synchronised.
class ArrivalStatistics {
  public:
    /// `steps`: simulation steps between two states of the topic.
    explicit ArrivalStatistics(std::uint32_t steps) : steps_(steps) {}

    /// Records a message received at `now_ns` (bus::wall_clock_ns()).
    void note(const msg::Header& header, std::uint64_t now_ns) {
        const double age = (static_cast<double>(now_ns) - static_cast<double>(header.send_time_ns())) * 1e-6;
        sum_ms_ += age;
        max_ms_ = count_++ == 0 ? age : std::max(max_ms_, age);
        // Chunks of one state share a number. A lower number is a late datagram, or, if lower by a second
        // or more, another session.
        const std::uint32_t number = header.number();
        if (last_ != 0 && number > last_) {
            missed_ += (number - last_ + steps_ / 2) / steps_ - 1;
        }
        if (number > last_ || last_ - number >= steps_per_second) {
            last_ = number;
        }
    }

    [[nodiscard]] std::uint64_t count() const { return count_; }
    [[nodiscard]] double mean_ms() const { return count_ > 0 ? sum_ms_ / static_cast<double>(count_) : 0.0; }
    [[nodiscard]] double max_ms() const { return max_ms_; }
    [[nodiscard]] std::uint64_t missed() const { return missed_; }

  private:
    std::uint32_t steps_, last_ = 0;
    std::uint64_t count_ = 0, missed_ = 0;
    double sum_ms_ = 0.0, max_ms_ = 0.0;
};

}  // namespace eti::client
