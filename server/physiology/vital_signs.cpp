// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/physiology/vital_signs.hpp"

#include <algorithm>
#include <cmath>

namespace eti::physiology {
namespace {

constexpr double dry_pressure = 713.0;   // [mmHg], of inspired gas without water vapour, at sea level
constexpr double gas_factor = 863.0;     // [mmHg mL/mL], conversion of gas at body temperature and pressure
                                         // to STPD
constexpr double bound_oxygen = 1.34;    // [mL/g], oxygen capacity of haemoglobin
constexpr double dissolved = 3.1e-5;     // [mL/(mL mmHg)], oxygen in plasma
constexpr double room_oxygen = 0.21;     // fraction of oxygen in the gas that enters the lungs during apnoea
constexpr double adult_p50 = 26.8;       // [mmHg], of the haemoglobin of Severinghaus's fit
constexpr double longest_step = 0.02;    // [s]; the fastest store empties within seconds
constexpr double oximeter_lag = 3.0;     // [s], of each of two stages: transport to the hand, averaging
constexpr double heart_lag = 2.4;        // [s], of the heart rate behind the saturation
constexpr double one_lung_shunt = 0.40;  // fraction of the blood, with the tube in one main bronchus
// The heart rate falls from `slows_below` on and is lowest at `slowest_at`.
constexpr double slows_below = 0.80, slowest_at = 0.30, slowest_heart = 60.0;

// Oxygen content of blood over its capacity below which consumption decreases.
constexpr double scarce = 0.1;

}  // namespace

Physiology newborn_physiology(double weight, double weeks, double inspired_oxygen) {
    // 0 up to 26 weeks, 1 at term.
    const double mature = std::clamp((weeks - 26.0) / 14.0, 0.0, 1.0);
    constexpr double minute = 60.0;
    Physiology p;
    p.functional_residual_capacity = 12.0 * weight;
    p.oxygen_consumption = std::lerp(7.0, 7.4, mature) / minute * weight;
    p.haemoglobin = 0.16;
    p.blood_volume = 85.0 * weight;
    p.cardiac_output = 220.0 / minute * weight;
    p.ventilation = 150.0 / minute * weight;
    p.shunt = std::lerp(0.10, 0.05, mature);
    p.p50 = std::lerp(18.0, 20.0, mature);
    p.heart_rate = std::lerp(155.0, 140.0, mature);
    p.inspired_oxygen = inspired_oxygen;
    return p;
}

double saturation_at(double pressure, double p50) {
    if (!(pressure > 0.0)) {
        return 0.0;
    }
    const double p = pressure * adult_p50 / p50;
    return 1.0 / (23400.0 / (p * p * p + 150.0 * p) + 1.0);
}

VitalSigns::VitalSigns(const Physiology& newborn) : newborn_(newborn) {
    // Steady state: ventilation supplies what metabolism consumes.
    const Physiology& n = newborn;
    alveolar_ = dry_pressure * n.inspired_oxygen - gas_factor * n.oxygen_consumption / n.ventilation;
    venous_ = content(alveolar_) - n.oxygen_consumption / (n.cardiac_output * (1.0 - n.shunt));
    arterial_ = carried_ = shown_ = saturation_behind(n.shunt);
    heart_rate_ = n.heart_rate;
}

double VitalSigns::content(double pressure) const {
    return bound_oxygen * newborn_.haemoglobin * saturation_at(pressure, newborn_.p50) +
           dissolved * std::max(pressure, 0.0);
}

double VitalSigns::saturation_behind(double shunt) const {
    const double arterial = (1.0 - shunt) * content(alveolar_) + shunt * venous_;
    // Content increases with pressure: bisection for the pressure, from which the saturation follows.
    double low = 0.0, high = dry_pressure;
    while (high - low > 1e-3) {
        const double middle = 0.5 * (low + high);
        (content(middle) < arterial ? low : high) = middle;
    }
    return saturation_at(low, newborn_.p50);
}

void VitalSigns::advance(double seconds, Ventilation ventilation) {
    const int steps = static_cast<int>(std::ceil(seconds / longest_step));
    for (int i = 0; i < steps; ++i) {
        step(seconds / steps, ventilation);
    }
}

void VitalSigns::step(double seconds, Ventilation ventilation) {
    const Physiology& n = newborn_;
    const double shunt = ventilation == Ventilation::one_lung ? std::max(n.shunt, one_lung_shunt) : n.shunt;
    const double uptake = n.cardiac_output * (1.0 - shunt) * (content(alveolar_) - venous_);
    const double brought = ventilation == Ventilation::none
                               ? room_oxygen * std::max(uptake, 0.0)
                               : n.ventilation * (dry_pressure * n.inspired_oxygen - alveolar_) / gas_factor;
    const double used =
        n.oxygen_consumption * std::clamp(venous_ / (scarce * bound_oxygen * n.haemoglobin), 0.0, 1.0);
    alveolar_ =
        std::max(alveolar_ + seconds * gas_factor / n.functional_residual_capacity * (brought - uptake), 0.0);
    venous_ = std::max(venous_ + seconds / n.blood_volume * (uptake - used), 0.0);

    arterial_ = saturation_behind(shunt);
    carried_ += (arterial_ - carried_) * std::min(seconds / oximeter_lag, 1.0);
    shown_ += (carried_ - shown_) * std::min(seconds / oximeter_lag, 1.0);

    // The heart rate recovers with the first breaths, before the saturation.
    const double want = std::clamp((slows_below - arterial_) / (slows_below - slowest_at), 0.0, 1.0);
    const double target =
        ventilation == Ventilation::none ? std::lerp(n.heart_rate, slowest_heart, want) : n.heart_rate;
    heart_rate_ += (target - heart_rate_) * std::min(seconds / heart_lag, 1.0);
}

}  // namespace eti::physiology
