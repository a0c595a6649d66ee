// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <chrono>

namespace eti {

/// Token bucket: limits events per second, with a burst allowance after a pause.
class RateLimiter {
  public:
    using Clock = std::chrono::steady_clock;

    explicit RateLimiter(double per_second) : per_second_(per_second), left_(per_second) {}

    [[nodiscard]] bool try_acquire(Clock::time_point now) {
        if (last_ != Clock::time_point{}) {
            const std::chrono::duration<double> passed = now - last_;
            left_ = std::min(per_second_, left_ + per_second_ * passed.count());
        }
        last_ = now;
        if (left_ < 1.0) {
            return false;
        }
        left_ -= 1.0;
        return true;
    }

  private:
    double per_second_, left_;
    Clock::time_point last_{};
};

}  // namespace eti
