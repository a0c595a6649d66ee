// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/aims.hpp"

#include <cmath>
#include <limits>

namespace eti {

namespace {

using enum AimMoment;
using P = AttemptMetrics;
constexpr double no_limit = std::numeric_limits<double>::infinity();

constexpr Aim aim_rows[] = {
    {"gum_force_n.max", [](const P& p, const P&) { return p.gum_force_max_n; }, 5.3, no_limit, false, crossed,
     "Lift along the handle, away from you; do not lever the blade on the upper gum"},
    {"attempts", [](const P& p, const P&) { return p.attempts; }, 1, 2, false, second_attempt,
     "See the glottis before advancing the tube; ask for suction or for head or larynx to be moved within "
     "the first attempt"},
    {"time_s", [](const P& p, const P&) { return p.time_s; }, 30, 45, true, crossed,
     "Have the tube in hand before the blade goes in; stop and ventilate when 30 s have passed"},
    {"oesophageal_entries", [](const P& p, const P&) { return p.oesophageal_entries; }, 0, 0, false, crossed,
     "Watch the tube's tip pass between the cords; do not advance without seeing them"},
    {"tube_depth_at_lip_cm",
     [](const P& p, const P&) { return std::abs(p.tube_depth_at_lip_cm - p.tube_depth_rule_cm); }, 0.5, 1,
     false, end, "Read the mark at the lip before the blade comes out: weight in kg plus 6 cm"},
    {"main_stem_entries", [](const P& p, const P&) { return p.main_stem_entries; }, 0, 0, false, crossed,
     "Stop when the tube's depth mark is at the cords"},
    {"cormack_lehane_grade", [](const P& p, const P&) { return p.cormack_lehane_grade; }, 1, 2, false,
     best_view,
     "Bring the blade's tip to the vallecula or under the epiglottis, then lift until half of the "
     "opening is in sight"},
    {"over_time_limit", [](const P& p, const P&) { return p.over_time_limit; }, 0, 0, false, crossed, ""},
    {"oxygen_saturation_percent.min",
     [](const P& p, const P& first) {
         return first.oxygen_saturation_end_percent - p.oxygen_saturation_min_percent;
     },
     10, 20, false, crossed,
     "Ventilate before the attempt, and stop it when saturation has fallen by 20 points"},
    // Below 60 a minute, chest compressions are indicated (Aziz et al. 2021, Pediatrics 147 Suppl 1).
    {"heart_rate_per_min.min", [](const P& p, const P&) { return 100 - p.heart_rate_min_per_min; }, 0, 40,
     false, crossed, "Stop and ventilate when the heart rate falls below 100 a minute"},
};

}  // namespace

constinit const std::span<const Aim> aims = aim_rows;

std::string_view name_of(AimStatus light) {
    constexpr std::string_view names[] = {"", "reached", "near", "missed"};
    return names[static_cast<std::size_t>(light)];
}

double shortfall(const Aim& aim, const AttemptMetrics& values, const AttemptMetrics& first) {
    const double value = aim.measure(values, first);
    if (!(value > aim.reached)) {
        return value - value;  // 0, or NaN for a value that does not exist
    }
    if (std::isinf(aim.near)) {
        return 1.0 - aim.reached / value;
    }
    return value > aim.near ? 1.0 + (value - aim.near) / (aim.near > 0 ? aim.near : 1.0)
                            : (value - aim.reached) / (aim.near - aim.reached);
}

AimStatus aim_status(double shortfall) {
    return std::isnan(shortfall) ? AimStatus::unknown
           : shortfall <= 0.0    ? AimStatus::reached
           : shortfall <= 1.0    ? AimStatus::near
                                 : AimStatus::missed;
}

}  // namespace eti
