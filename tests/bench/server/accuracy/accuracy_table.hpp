// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <string_view>

#include "tests/bench/server/table.hpp"

namespace eti::bench {

struct AccuracyRow {
    std::string_view name;  ///< of the case
    std::string_view method;
    double spacing = 0.0;  ///< [m]
    int substeps = 1;      ///< per step of 1/180 s
    int iterations = 1;    ///< passes per substep
    std::size_t particles = 0;
    double error = 0.0;     ///< relative; not finite if the body diverged
    double frame_ms = 0.0;  ///< wall time per simulated 1/90 s
};

/// accuracy.csv.
class AccuracyTable {
  public:
    AccuracyTable(const std::filesystem::path& folder, Shard& shard)
        : shard_(shard),
          table_(folder, "accuracy.csv",
                 "case,method,spacing_mm,substeps,iterations,particles,relative_error,ms_per_frame", &shard) {
    }

    /// This process's share of the runs of the sweep.
    [[nodiscard]] Shard& shard() { return shard_; }

    void add(const AccuracyRow& r) {
        table_.row(fmt::format("{},\"{}\",{:g},{},{},{},{},{:.6g}", r.name, r.method, 1e3 * r.spacing,
                               r.substeps, r.iterations, r.particles,
                               std::isfinite(r.error) ? fmt::format("{:.6g}", r.error) : "inf", r.frame_ms));
    }
    [[nodiscard]] const std::filesystem::path& path() const { return table_.path(); }

  private:
    Shard& shard_;
    Table table_;
};

/// The tube: held by its connector with a force across its tip, against the elastica; and bent over two
/// supports, against the beam's closed form.
void bend_tubes(AccuracyTable& table, bool quick);

/// Water: a column at rest, and the dam break of Martin & Moyce 1952.
void pour_water(AccuracyTable& table, bool quick);

}  // namespace eti::bench
