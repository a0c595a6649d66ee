// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "server/pbd/particles.hpp"
#include "tests/bench/server/table.hpp"

namespace eti::bench {

/// Outcome for a disturbed body. It survives if it returns and never moves farther away than it was
/// displaced; it recovers if it returns by a detour.
enum class Fate { fails, recovers, survives };

[[nodiscard]] constexpr std::string_view name_of(Fate fate) {
    switch (fate) {
        case Fate::fails:
            return "fails";
        case Fate::recovers:
            return "recovers";
        case Fate::survives:
            break;
    }
    return "survives";
}

/// One cell of a map, with its measurements; NaN where a measurement does not apply.
struct RecoveryResult {
    static constexpr double none = std::numeric_limits<double>::quiet_NaN();
    Fate fate = Fate::fails;
    double return_time = none;     ///< [s], after which all stays within 1 % of the body's size from rest
    double residual = none;        ///< final distance from rest, relative to the body's size
    double kinetic_growth = none;  ///< maximum kinetic energy in the second half over that in the first
    double rotation_error = none;  ///< maximum deviation of a cluster's rotation from a proper one
};

/// Observes a body on its way back to rest.
class RecoveryTracker {
  public:
    /// `size` [m] is the body's, `duration` [s] the time of observation.
    RecoveryTracker(double size, double duration) : size_(size), duration_(duration) {}

    /// `away` [m]: the largest distance of a particle from its rest position; `kinetic` [J].
    void observe(double time, double away, double kinetic) {
        now_ = std::isfinite(away) ? away : lost;
        farthest_ = std::max(farthest_, now_);
        if (now_ > tolerance * size_) {
            back_since_ = RecoveryResult::none;
        } else if (std::isnan(back_since_)) {
            back_since_ = time;
        }
        double& peak = time < 0.5 * duration_ ? first_peak_ : second_peak_;
        peak = std::isfinite(kinetic) ? std::max(peak, kinetic) : std::numeric_limits<double>::infinity();
    }

    /// A rotation at any time; proper ones are unit quaternions.
    void observe(const Quatf& rotation) {
        const double error = std::fabs(static_cast<double>(rotation.coeffs().squaredNorm()) - 1.0);
        rotation_error_ = std::fmax(rotation_error_, std::isfinite(error) ? error : lost);
    }

    /// `thrown` [m]: the initial displacement. Anything beyond that plus a tenth of the size is a detour.
    [[nodiscard]] RecoveryResult result(double thrown) const {
        RecoveryResult out;
        out.return_time = back_since_;
        out.residual = now_ / size_;
        out.kinetic_growth = first_peak_ > 0.0 ? second_peak_ / first_peak_ : RecoveryResult::none;
        out.rotation_error = rotation_error_;
        // A quaternion normalised in float32 misses the unit by a few roundings of 6e-8.
        const bool proper = !(rotation_error_ > 1e-6);
        if (!std::isnan(back_since_) && proper) {
            out.fate = farthest_ > thrown + 0.1 * size_ ? Fate::recovers : Fate::survives;
        }
        return out;
    }

    static constexpr double tolerance = 0.01;  ///< relative to the size; counts as at rest

  private:
    static constexpr double lost = 1e9;
    double size_, duration_;
    double now_ = lost;
    double farthest_ = 0.0;
    double back_since_ = RecoveryResult::none;
    double first_peak_ = 0.0, second_peak_ = 0.0;
    double rotation_error_ = RecoveryResult::none;
};

/// Largest distance [m] of a particle from its rest position; infinite if one is NaN.
[[nodiscard]] inline double farthest_from_rest(const pbd::Particles& particles) {
    double worst = 0.0;
    for (std::size_t i = 0; i < particles.size(); ++i) {
        const double away = static_cast<double>((particles.position[i] - particles.rest[i]).norm());
        worst = std::isfinite(away) ? std::max(worst, away) : std::numeric_limits<double>::infinity();
    }
    return worst;
}

/// [J], of the free particles.
[[nodiscard]] inline double kinetic_energy(const pbd::Particles& particles) {
    double sum = 0.0;
    for (std::size_t i = 0; i < particles.size(); ++i) {
        if (particles.inverse_mass[i] > 0.0f) {
            sum += 0.5 * static_cast<double>(particles.velocity[i].squaredNorm() / particles.inverse_mass[i]);
        }
    }
    return sum;
}

/// The maps, written cell by cell.
class StabilityTable {
  public:
    StabilityTable(const std::filesystem::path& folder, Shard& shard)
        : shard_(shard),
          table_(folder, "stability.csv",
                 "figure,map,method,row,column,fate,return_s,residual,kinetic_growth,rotation_error",
                 &shard) {}

    /// `figure` holds the panels of its maps, one line of panels per map, one panel per method. `course`
    /// computes the cell's RecoveryResult if the cell belongs to this process.
    template <std::invocable Work>
    void add(std::string_view figure, std::string_view map, std::string_view method, std::string_view row,
             std::string_view column, const Work& course) {
        if (!shard_.claim_next()) {
            return;
        }
        const RecoveryResult c = course();
        table_.row(fmt::format("{},\"{}\",\"{}\",\"{}\",{},{},{},{},{},{}", figure, map, method, row, column,
                               name_of(c.fate), number(c.return_time), number(c.residual),
                               number(c.kinetic_growth), number(c.rotation_error)));
    }

    [[nodiscard]] const std::filesystem::path& path() const { return table_.path(); }

  private:
    [[nodiscard]] static std::string number(double value) {
        return std::isnan(value) ? "" : fmt::format("{:.3g}", value);
    }
    Shard& shard_;
    Table table_;
};

}  // namespace eti::bench
