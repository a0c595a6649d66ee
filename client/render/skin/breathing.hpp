// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

namespace eti::render {

/// A ventilated newborn's tidal breaths, drawn as a rising chest and abdomen; nothing else depends on it. The
/// session simulates ventilation without single breaths, so that their phase is the client's own.
class Breathing {
  public:
    /// In simulation time; without ventilation the lungs empty and stay so. Starts anew where time goes back.
    void update(double time_s, bool ventilated);

    /// 0 at the end of expiration to 1 at the end of inspiration.
    [[nodiscard]] float inflation() const { return static_cast<float>(inflation_); }

  private:
    std::optional<double> time_s_;
    double phase_s_ = 0.0;  // since the inspiration began
    double inflation_ = 0.0;
};

}  // namespace eti::render
