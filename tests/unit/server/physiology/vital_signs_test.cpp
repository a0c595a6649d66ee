// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/physiology/vital_signs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace eti::physiology {
namespace {

constexpr double tick = 1.0 / 180.0;  // [s]

// [s] of apnoea until the oximeter shows less than `percent`; infinite if it does not within five minutes.
double time_to(double percent, const Physiology& newborn) {
    VitalSigns signs(newborn);
    for (double t = 0.0; t < 300.0; t += tick) {
        if (signs.oxygen_saturation() < percent) {
            return t;
        }
        signs.advance(tick, Ventilation::none);
    }
    return std::numeric_limits<double>::infinity();
}

void hold(VitalSigns& signs, double seconds, Ventilation ventilation) {
    for (double t = 0.0; t < seconds; t += tick) {
        signs.advance(tick, ventilation);
    }
}

// Kothari et al. 2021 (Arch Dis Child Fetal Neonatal Ed 106:603): 78 newborns of 27 weeks and 946 g (medians)
// who were intubated. From the last breath to a saturation below 90, 80 and 60 % it took 22 (14-32), 35
// (24-44) and 56 (42-68) s, median and quartiles. They received as little oxygen as maintained 90 % and more;
// the test uses 25 % oxygen.
TEST(VitalSigns, PretermDesaturationMatchesKothari2021) {
    const Physiology newborn = newborn_physiology(0.946, 27.0, 0.25);
    const double to_90 = time_to(90.0, newborn), to_80 = time_to(80.0, newborn),
                 to_60 = time_to(60.0, newborn);
    EXPECT_GT(to_90, 14.0);
    EXPECT_LT(to_90, 32.0);
    EXPECT_GT(to_80, 24.0);
    EXPECT_LT(to_80, 44.0);
    EXPECT_GT(to_60, 42.0);
    EXPECT_LT(to_60, 68.0);
}

// Patel et al. 1994 (Can J Anaesth 41:771): infants up to 6 months, paralysed and washed out with oxygen
// until less than 3 % of nitrogen was left, reached 90 % after 96.5 s, standard deviation 12.7 s.
TEST(VitalSigns, PreoxygenatedInfantMatchesPatel1994) {
    EXPECT_NEAR(time_to(90.0, newborn_physiology(4.0, 40.0, 0.97)), 96.5, 12.7);
}

// The equation of Severinghaus 1979 (J Appl Physiol 46:599) as in the program po2so2: 0.905818 at 8 kPa.
// Adult blood is three quarters saturated at 40 mmHg, and half saturated at the P50.
TEST(VitalSigns, SaturationFollowsThePublishedCurve) {
    EXPECT_NEAR(saturation_at(8.0 * 7.50062, 26.8), 0.905818, 1e-5);
    EXPECT_NEAR(saturation_at(40.0, 26.8), 0.75, 0.01);
    EXPECT_NEAR(saturation_at(19.0, 19.0), 0.5, 5e-3);
    EXPECT_EQ(saturation_at(0.0, 19.0), 0.0);
    EXPECT_EQ(saturation_at(std::numeric_limits<double>::quiet_NaN(), 19.0), 0.0);
}

TEST(VitalSigns, VentilationKeepsSteadyState) {
    for (const double oxygen : {0.21, 0.3, 1.0}) {
        VitalSigns signs(newborn_physiology(3.5, 40.0, oxygen));
        const double saturation = signs.oxygen_saturation(), rate = signs.heart_rate();
        EXPECT_GT(saturation, 97.0);
        hold(signs, 120.0, Ventilation::both_lungs);
        EXPECT_NEAR(signs.oxygen_saturation(), saturation, 0.05);
        EXPECT_NEAR(signs.heart_rate(), rate, 0.05);
    }
}

// Oxygen is conserved: without breaths, the stores lose what metabolism consumes. The rate late in the
// apnoea, with empty lungs, follows from the blood alone (Sands et al. 2009, stage 2).
TEST(VitalSigns, EmptyLungsDesaturateAtBloodStoreRate) {
    Physiology newborn = newborn_physiology(1.1, 28.0, 0.21);
    newborn.shunt = 0.0;
    VitalSigns signs(newborn);
    hold(signs, 40.0, Ventilation::none);
    const double before = signs.arterial_saturation();
    hold(signs, 5.0, Ventilation::none);
    const double fall = (before - signs.arterial_saturation()) / 5.0;  // [%/s]
    const double blood =
        100.0 * newborn.oxygen_consumption / (1.34 * newborn.haemoglobin * newborn.blood_volume);
    // The lungs' remaining oxygen, and the air that flows in, slow it a little.
    EXPECT_LT(fall, blood);
    EXPECT_GT(fall, 0.75 * blood);
}

TEST(VitalSigns, PreoxygenationSlowsDesaturation) {
    EXPECT_LT(time_to(80.0, newborn_physiology(3.5, 40.0, 0.21)),
              time_to(80.0, newborn_physiology(3.5, 40.0, 0.4)));
    EXPECT_LT(time_to(80.0, newborn_physiology(3.5, 40.0, 0.4)),
              time_to(80.0, newborn_physiology(3.5, 40.0, 1.0)));
}

// Henderson-Smart et al. 1986 (Arch Dis Child 61:227): the heart slows 2.4 s after the saturation begins to
// fall, and recovers with the air flow, before the saturation does.
TEST(VitalSigns, HeartRateFallsLateAndRecoversFirst) {
    VitalSigns signs(newborn_physiology(1.1, 28.0, 0.25));
    const double rest = signs.heart_rate();
    double saturation_fell = -1.0, heart_fell = -1.0, t = 0.0;
    for (; signs.heart_rate() > 105.0; t += tick) {
        ASSERT_LT(t, 300.0);
        signs.advance(tick, Ventilation::none);
        if (saturation_fell < 0.0 && signs.arterial_saturation() < 80.0) {
            saturation_fell = t;
        }
        if (heart_fell < 0.0 && signs.heart_rate() < rest - 5.0) {
            heart_fell = t;
        }
    }
    EXPECT_GT(heart_fell, saturation_fell);
    double heart_back = -1.0, saturation_back = -1.0;
    for (t = 0.0; heart_back < 0.0 || saturation_back < 0.0; t += tick) {
        ASSERT_LT(t, 60.0);
        signs.advance(tick, Ventilation::both_lungs);
        if (heart_back < 0.0 && signs.heart_rate() > 0.95 * rest) {
            heart_back = t;
        }
        if (saturation_back < 0.0 && signs.oxygen_saturation() > 90.0) {
            saturation_back = t;
        }
    }
    EXPECT_LT(heart_back, saturation_back);
    EXPECT_LT(saturation_back, 30.0);
}

TEST(VitalSigns, OneLungVentilationLowersSaturation) {
    VitalSigns both(newborn_physiology(3.5, 40.0, 0.3)), one = both;
    hold(both, 90.0, Ventilation::both_lungs);
    hold(one, 90.0, Ventilation::one_lung);
    EXPECT_LT(one.oxygen_saturation(), both.oxygen_saturation() - 3.0);
    EXPECT_GT(one.oxygen_saturation(), 50.0);
}

TEST(VitalSigns, ValuesStayInRangeForLongCoarseSteps) {
    for (const double weight : {0.5, 4.5}) {
        VitalSigns signs(newborn_physiology(weight, weight < 1.0 ? 22.0 : 42.0, 0.21));
        for (int i = 0; i < 100; ++i) {
            signs.advance(10.0, Ventilation::none);
            ASSERT_GE(signs.oxygen_saturation(), 0.0);
            ASSERT_LE(signs.oxygen_saturation(), 100.0);
            ASSERT_GE(signs.heart_rate(), 59.9);
        }
        hold(signs, 120.0, Ventilation::both_lungs);
        EXPECT_GT(signs.oxygen_saturation(), 95.0) << "recovers from the deepest";
    }
}

}  // namespace
}  // namespace eti::physiology
