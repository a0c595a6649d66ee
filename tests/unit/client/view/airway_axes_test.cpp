// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/sight/airway_axes.hpp"

#include <gtest/gtest.h>

#include "common/math/units.hpp"

namespace eti::view {
namespace {

// Throat straight down, -z; larynx leaning by `lean` from it towards anterior, -y.
Landmarks airway(float lean) {
    Landmarks points = zero_landmarks();
    const auto put = [&](Landmark which, const Vec3f& p) { points[static_cast<std::size_t>(which)] = p; };
    put(Landmark::mouth_opening, {0.0f, -0.02f, 0.0f});
    put(Landmark::oesophagus_inlet, {0.0f, 0.02f, -0.05f});
    put(Landmark::oesophagus_mid, {0.0f, 0.02f, -0.09f});
    const Vec3f glottis(0.0f, 0.01f, -0.05f);
    put(Landmark::glottis, glottis);
    put(Landmark::trachea_mid, glottis + 0.03f * Vec3f(0.0f, -std::sin(lean), -std::cos(lean)));
    return points;
}

TEST(AirwayAxes, AnglesFollowHeadAndLarynx) {
    for (const float elevation : {0.0f, 10.0f, 30.0f}) {
        const AirwayAxes axes = airway_axes(airway(15.0f * degree), elevation * degree);
        // The palate faces backwards, and with the chin up also downwards: towards the throat's axis.
        EXPECT_NEAR(axes.mouth_to_throat / degree, 90.0f - elevation, 1e-3f) << elevation;
        EXPECT_NEAR(axes.throat_to_larynx / degree, 15.0f, 1e-3f);
    }
}

TEST(AirwayAxes, PassThroughTheirLandmarks) {
    const Landmarks points = airway(0.2f);
    const AirwayAxes axes = airway_axes(points, 0.3f);
    const std::array places{Landmark::mouth_opening, Landmark::oesophagus_inlet, Landmark::glottis};
    for (std::size_t i = 0; i < places.size(); ++i) {
        const AirwayAxis& axis = axes.axes[i];
        const Vec3f middle = 0.5f * (axis.from + axis.to);
        EXPECT_LT((middle - at(points, places[i])).norm(), 1e-6f) << axis.name;
    }
}

}  // namespace
}  // namespace eti::view
