// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/labelled_anatomy.hpp"

#include <gtest/gtest.h>

#include "coarse_phantom.hpp"
#include "common/math/units.hpp"
#include "server/patient/newborn/build/build.hpp"
#include "server/patient/newborn/build/check_model.hpp"
#include "server/patient/segmentation/grids/label_distance.hpp"

namespace eti::segmentation {
namespace {

using test::coarse_phantom;
using test::silent;

/// The labels of a phantom whose volume is shifted and tilted, as by a scanner's frame.
imaging::Mask moved(imaging::Mask labels, float tilt, const Vec3d& by) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(static_cast<double>(tilt), Vec3d::UnitX()).toRotationMatrix();
    labels.geometry.origin = turn * labels.geometry.origin + by;
    labels.geometry.step = turn * labels.geometry.step;
    return labels;
}

TEST(Registration, RecoversPhantomSizeTiltAndPosition) {
    for (const float weight : {1.5f, 3.5f}) {
        PhantomSettings settings;
        settings.newborn.weight = weight;
        settings.newborn.gestational_age = median_gestational_age(weight);
        settings.spacing = 1.2e-3f * std::cbrt(weight / 3.5f);  // as many voxels across either head
        const Phantom phantom = make_phantom(settings, silent);
        const Vec3d by(0.04, -0.11, 0.9);
        const float tilt = 25.0f * degree;
        const Registration found = register_newborn(moved(phantom.labels, tilt, by));
        // Surfaces of labels are known to about half a voxel: 1.5 % of the jaw's 65 mm at term.
        EXPECT_NEAR(std::cbrt(found.weight / weight), 1.0f, 0.03f) << weight;
        EXPECT_LT(found.off, 0.6e-3) << weight;
        const Quatf turn(Eigen::AngleAxisf(tilt, Vec3f::UnitX()));
        EXPECT_LT(turn.angularDistance(found.place.rotation) / degree, 1.5f) << weight;
        EXPECT_LT((found.place.translation - by.cast<float>()).norm(), 1.0e-3f) << weight;
    }
}

TEST(LabelledAnatomy, MatchesPhantomGroundTruth) {
    const Phantom& phantom = coarse_phantom(1.0e-3f);
    const LabelledAnatomy anatomy(phantom.labels, phantom.landmarks, silent);
    const patient::Newborn truth(PhantomSettings().newborn);
    // Compared in the volume's frame, which is the phantom's.
    double wrong = 0.0;
    double count = 0.0;
    const auto [low, high] = truth.airway_bounds();
    const RigidTransform back = anatomy.registration().place.inverse();
    for (float z = low.z(); z < high.z(); z += 2e-3f) {
        for (float y = low.y(); y < high.y(); y += 2e-3f) {
            for (float x = low.x(); x < high.x(); x += 2e-3f) {
                const Vec3f point(x, y, z);
                const patient::Fields is = anatomy.fields(back * point);
                const patient::Fields was = truth.fields(point);
                // Where the truth is clearly air or clearly tissue, a millimetre from the border.
                const float air = std::max({was.cavity, -was.tongue, -was.epiglottis});
                const float found = std::max({is.cavity, -is.tongue, -is.epiglottis});
                if (was.skin < -1e-3f && std::fabs(air) > 1e-3f) {
                    count += 1.0;
                    wrong += (air < 0.0f) != (found < 0.0f) ? 1.0 : 0.0;
                }
            }
        }
    }
    EXPECT_GT(count, 5000.0);
    EXPECT_LT(wrong / count, 0.01);
    const auto landmarks = truth.landmarks();
    for (std::size_t i = 0; i < landmark_count; ++i) {
        EXPECT_LT((anatomy.registration().place * anatomy.landmarks()[i] - landmarks[i]).norm(), 1e-5f)
            << landmark_names[i] << " was given";
    }
}

TEST(LabelledAnatomy, BuildsValidModel) {
    const Phantom& phantom = coarse_phantom(1.0e-3f);
    const LabelledAnatomy anatomy(phantom.labels, {}, silent);
    const patient::Patient patient = patient::build_patient(
        anatomy, {.spacing = 3.0e-3f, .fine_spacing = 1.5e-3f, .surface_spacing = 2.0e-3f});
    for (const patient::Invariant& i : patient::check_model(patient)) {
        EXPECT_TRUE(i.holds) << i.name << ": " << i.found;
    }
    EXPECT_FALSE(anatomy.remarks().empty()) << "voxels of 1 mm do not show the epiglottis";
}

TEST(LabelledAnatomy, MissingLarynxIsRefused) {
    Phantom phantom = coarse_phantom(2.0e-3f);
    imaging::Geometry& g = phantom.labels.geometry;
    // Cuts the volume off just below the chin.
    const auto cut = static_cast<int>((-0.028 - g.origin.z()) / g.step(2, 2));
    phantom.labels.value.erase(
        phantom.labels.value.begin(),
        phantom.labels.value.begin() + static_cast<std::ptrdiff_t>(g.index(0, 0, cut)));
    g.origin.z() += cut * g.step(2, 2);
    g.size[2] -= cut;
    EXPECT_THROW(LabelledAnatomy(phantom.labels, {}, silent), NoLarynxError);

    Phantom jawless = coarse_phantom(2.0e-3f);
    for (std::uint8_t& v : jawless.labels.value) {
        v = v == value_of(Label::mandible) ? value_of(Label::bone) : v;
    }
    EXPECT_THROW(LabelledAnatomy(jawless.labels, {}, silent), NoLarynxError);
}

TEST(LabelDistance, MatchesDistanceToBall) {
    imaging::Mask labels;
    labels.geometry.size = {41, 41, 41};
    labels.geometry.step = 0.5e-3 * Eigen::Matrix3d::Identity();
    labels.value.assign(labels.geometry.count(), 0);
    const Vec3d centre(10e-3, 10e-3, 10e-3);
    constexpr double radius = 5e-3;
    for (std::size_t i = 0; i < labels.value.size(); ++i) {
        const auto [x, y, z] = labels.geometry.coordinates(i);
        labels.value[i] = (labels.geometry.point(x, y, z) - centre).norm() < radius ? 1 : 0;
    }
    const DistanceGrid d = distance_of(labels.geometry, select(labels, {Label::soft}));
    for (const float away : {0.0f, 2e-3f, 4.5e-3f, 5.5e-3f, 7e-3f, 9e-3f}) {
        const Vec3f p = centre.cast<float>() + away * Vec3f(0.6f, 0.0f, 0.8f);
        // Half a voxel, and the blur's shrinking by variance over radius.
        EXPECT_NEAR(d.distance(p), away - static_cast<float>(radius), 0.3e-3f) << away;
    }
}

}  // namespace
}  // namespace eti::segmentation
