// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::metrics {

/// What decides how fast a newborn runs out of oxygen. Sources and ranges: docs/vital-signs.md.
struct Physiology {
    double lung_volume = 0.0;       ///< [mL], gas left at the end of a breath, relaxed
    double oxygen_use = 0.0;        ///< [mL/s], STPD
    double haemoglobin = 0.0;       ///< [g/mL]
    double blood_volume = 0.0;      ///< [mL]
    double cardiac_output = 0.0;    ///< [mL/s]
    double ventilation = 0.0;       ///< [mL/s] of the alveoli, while somebody ventilates
    double shunt = 0.0;             ///< share of the blood that passes the lungs by
    double half_saturation = 0.0;   ///< [mmHg], P50 of the haemoglobin
    double heart_rate = 0.0;        ///< [1/min], at rest
    double inspired_oxygen = 0.21;  ///< share of the gas that the newborn is ventilated with
};

/// Of a newborn of `weight` [kg] and `weeks` of gestation, ventilated with `inspired_oxygen` (0.21 to 1).
[[nodiscard]] Physiology physiology(double weight, double weeks, double inspired_oxygen);

/// Share of saturated haemoglobin at an oxygen pressure [mmHg], by Severinghaus 1979 (J Appl Physiol 46:599),
/// whose curve is shifted to the P50 given.
[[nodiscard]] double saturation_at(double pressure, double half_saturation);

/// Who moves gas in and out of the lungs.
enum class Ventilation { none, one_lung, both_lungs };

/// Oxygen saturation and heart rate of one newborn: a store of oxygen in the lungs and one in the blood, with
/// the metabolism drawing on the blood (after Sands et al. 2009, PLoS Comput Biol 5:e1000588, without its
/// parts that matter within a breath). While nobody ventilates, room air follows what the blood takes up.
class VitalSigns {
  public:
    VitalSigns() = default;
    /// Ventilated for long.
    explicit VitalSigns(const Physiology& newborn);

    void advance(double seconds, Ventilation ventilation);

    /// [%], as a pulse oximeter at the hand shows it: later than in the heart, and averaged.
    [[nodiscard]] double oxygen_saturation() const { return 100.0 * shown_; }
    /// [%], of the blood that leaves the heart.
    [[nodiscard]] double arterial_saturation() const { return 100.0 * arterial_; }
    /// [1/min]
    [[nodiscard]] double heart_rate() const { return heart_rate_; }

  private:
    void step(double seconds, Ventilation ventilation);
    [[nodiscard]] double content(double pressure) const;         // [mL oxygen per mL blood]
    [[nodiscard]] double saturation_behind(double shunt) const;  // share, of the blood that leaves the heart

    Physiology newborn_;
    double alveolar_ = 0.0;                                // [mmHg], oxygen
    double venous_ = 0.0;                                  // [mL/mL], oxygen content
    double arterial_ = 0.0, carried_ = 0.0, shown_ = 0.0;  // saturation at the heart, on its way, as shown
    double heart_rate_ = 0.0;
};

}  // namespace eti::metrics
