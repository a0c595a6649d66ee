// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::physiology {

/// Parameters that determine how fast a newborn desaturates. Sources and ranges: docs/vital-signs.md.
struct Physiology {
    double functional_residual_capacity = 0.0;  ///< [mL], lung volume at the end of a relaxed expiration
    double oxygen_consumption = 0.0;            ///< [mL/s], STPD
    double haemoglobin = 0.0;                   ///< [g/mL]
    double blood_volume = 0.0;                  ///< [mL]
    double cardiac_output = 0.0;                ///< [mL/s]
    double ventilation = 0.0;                   ///< [mL/s], alveolar, during ventilation
    double shunt = 0.0;                         ///< fraction of the blood that bypasses the lungs
    double p50 = 0.0;                           ///< [mmHg], P50 of haemoglobin
    double heart_rate = 0.0;                    ///< [1/min], at rest
    double inspired_oxygen = 0.21;              ///< fraction of oxygen in the ventilation gas (FiO2)
};

/// Parameters of a newborn of `weight` [kg] and `weeks` of gestation, ventilated with `inspired_oxygen` (0.21
/// to 1).
[[nodiscard]] Physiology newborn_physiology(double weight, double weeks, double inspired_oxygen);

/// Oxygen saturation (0 to 1) at an oxygen pressure [mmHg]: the curve of Severinghaus 1979 (J Appl Physiol
/// 46:599), shifted to the given P50.
[[nodiscard]] double saturation_at(double pressure, double p50);

/// What is ventilated.
enum class Ventilation { none, one_lung, both_lungs };

/// Oxygen saturation and heart rate of one newborn: one oxygen store in the lungs, one in the blood, and
/// metabolism drawing on the blood (after Sands et al. 2009, PLoS Comput Biol 5:e1000588, without its
/// within-breath dynamics). During apnoea, room air replaces the gas that the blood takes up.
class VitalSigns {
  public:
    VitalSigns() = default;
    /// Starts in the steady state of ventilation.
    explicit VitalSigns(const Physiology& newborn);

    void advance(double seconds, Ventilation ventilation);

    /// [%], as a pulse oximeter at the hand displays it: delayed with respect to the heart, and averaged.
    [[nodiscard]] double oxygen_saturation() const { return 100.0 * shown_; }
    /// [%], of the blood leaving the heart.
    [[nodiscard]] double arterial_saturation() const { return 100.0 * arterial_; }
    /// [1/min]
    [[nodiscard]] double heart_rate() const { return heart_rate_; }

  private:
    void step(double seconds, Ventilation ventilation);
    [[nodiscard]] double content(double pressure) const;         // [mL oxygen per mL blood]
    [[nodiscard]] double saturation_behind(double shunt) const;  // fraction, of the blood leaving the heart

    Physiology newborn_;
    double alveolar_ = 0.0;                                // [mmHg], oxygen pressure
    double venous_ = 0.0;                                  // [mL/mL], oxygen content
    double arterial_ = 0.0, carried_ = 0.0, shown_ = 0.0;  // saturation: at the heart, after transport, as
                                                           // displayed
    double heart_rate_ = 0.0;
};

}  // namespace eti::physiology
