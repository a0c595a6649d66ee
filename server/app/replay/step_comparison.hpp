// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/session/record.hpp"

namespace eti::app {

/// The first value that differs.
struct StepDifference {
    std::uint64_t step = 0;
    double time = 0.0;   ///< [s]
    std::string series;  ///< e.g. "tools/proxy_pose"
    double recorded = 0.0, simulated = 0.0;
};

/// Compares simulated steps with recorded ones, bit by bit, in every series.
class StepComparison {
  public:
    /// `holds`: whether the file contains a row of a series; missing rows are not compared.
    StepComparison(std::size_t tube_nodes,
                   std::function<bool(const std::string& series, std::size_t row)> holds)
        : tube_nodes_(tube_nodes), has_row_(std::move(holds)) {}

    /// `row`: row in the file.
    void compare(const session::StepRecord& recorded, const session::StepRecord& simulated, std::size_t row);

    [[nodiscard]] const std::optional<StepDifference>& first() const { return first_; }
    [[nodiscard]] std::uint64_t steps() const { return steps_; }  ///< steps compared
    [[nodiscard]] std::uint64_t equal() const { return equal_; }  ///< equal steps among them

  private:
    std::size_t tube_nodes_;
    std::function<bool(const std::string&, std::size_t)> has_row_;
    std::optional<StepDifference> first_;
    std::uint64_t steps_ = 0, equal_ = 0;
    std::vector<std::byte> recorded_, simulated_;
};

}  // namespace eti::app
