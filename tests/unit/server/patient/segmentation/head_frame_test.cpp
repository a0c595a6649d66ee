// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/placement/head_frame.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <initializer_list>

#include "coarse_phantom.hpp"
#include "common/math/random.hpp"
#include "server/patient/segmentation/segment.hpp"

namespace eti::segmentation {
namespace {

using test::coarse_phantom;

constexpr double radians_per_degree = M_PI / 180.0;

Eigen::Matrix3d turn_about(const Vec3d& axis, double degrees) {
    return Eigen::AngleAxisd(degrees * radians_per_degree, axis.normalized()).toRotationMatrix();
}

/// The same voxels of a rotated patient.
imaging::Volume turned(imaging::Volume volume, const Eigen::Matrix3d& turn) {
    volume.geometry.origin = turn * volume.geometry.origin;
    volume.geometry.step = turn * volume.geometry.step;
    return volume;
}

double off(const HeadFrame& found, const Eigen::Matrix3d& truth) {
    return Eigen::AngleAxisd(Eigen::Matrix3d(truth.transpose() * found.axes)).angle() / radians_per_degree;
}

const Vec3d left = Vec3d::UnitX();
const Vec3d back = Vec3d::UnitY();
const Vec3d up = Vec3d::UnitZ();

void expect_found(std::initializer_list<Eigen::Matrix3d> turns) {
    const imaging::Volume& ct = coarse_phantom(2.0e-3f).ct;
    for (const Eigen::Matrix3d& turn : turns) {
        const HeadFrame found = find_head(turned(ct, turn), {});
        // A coarse voxel of 2.5 mm across a head of 100 mm is 1.4 degrees.
        EXPECT_LT(off(found, turn), 3.0) << turn;
        EXPECT_NEAR(found.size, 36e-3, 3e-3);
        EXPECT_TRUE(found.vault);
        // Position of the cranium: the phantom's lies 66 mm behind and 56 mm above the gum.
        EXPECT_LT((turn.transpose() * found.centre - Vec3d(0, 66e-3, 56e-3)).norm(), 6e-3) << turn;
    }
}

TEST(HeadFrame, IsFoundForAnyHeadOrientation) {
    expect_found({turn_about(left, 0.0), turn_about(Vec3d(1, -1, 1), 40.0), turn_about(left, 180.0)});
}

TEST(WholeHeadFrame, IsFoundForAnyHeadOrientation) {
    expect_found({turn_about(left, 30.0), turn_about(left, -45.0), turn_about(back, 30.0),
                  turn_about(up, 45.0), turn_about(back, 90.0), turn_about(up, 170.0)});
}

TEST(HeadFrame, IsFoundWithoutAVault) {
    imaging::Volume ct = coarse_phantom(2.0e-3f).ct;
    imaging::Geometry& g = ct.geometry;
    g.size[2] =
        static_cast<int>(std::lround(g.to_index(Vec3d(0, 0, 28e-3)).z()));  // below the cranium's floor
    ct.value.resize(g.count());
    const Eigen::Matrix3d turn = turn_about(Vec3d(1, 0.5, 0), 25.0);
    const HeadFrame found = find_head(turned(ct, turn), {});
    EXPECT_FALSE(found.vault);
    EXPECT_LT(off(found, turn), 4.0);
    EXPECT_NEAR(found.size, 36e-3, 4e-3);
}

TEST(HeadFrame, IsIndependentOfHeadSize) {
    imaging::Volume ct = coarse_phantom(2.0e-3f, 1.2f).ct;
    const HeadFrame preterm = find_head(ct, {});
    EXPECT_LT(off(preterm, Eigen::Matrix3d::Identity()), 3.0);
    // A newborn as large as an adult.
    ct = coarse_phantom(2.0e-3f).ct;
    ct.geometry.step *= 1.8;
    ct.geometry.origin *= 1.8;
    const HeadFrame adult = find_head(ct, {});
    EXPECT_LT(off(adult, Eigen::Matrix3d::Identity()), 3.0);
    EXPECT_NEAR(adult.size, 1.8 * 36e-3, 6e-3);
}

/// A volume of 2 mm voxels, [mm] from its middle to Hounsfield units, with noise of 20 HU.
imaging::Volume drawn(const std::function<double(double, double, double)>& value) {
    imaging::Volume ct;
    ct.geometry.size = {100, 100, 100};
    ct.geometry.step = 2e-3 * Eigen::Matrix3d::Identity();
    Random random(7);
    for (std::size_t i = 0; i < ct.geometry.count(); ++i) {
        const auto [x, y, z] = ct.geometry.coordinates(i);
        ct.value.push_back(static_cast<float>(value(2.0 * x - 99.0, 2.0 * y - 99.0, 2.0 * z - 99.0)) +
                           20.0f * random.normal());
    }
    return ct;
}

/// Ribs, spine and sternum around lungs and heart, with a trachea.
double chest(double x, double y, double z) {
    const auto ellipse = [](double a, double b, double c = 0.0) { return a * a + b * b + c * c; };
    if (ellipse(x / 95, y / 72) > 1.0) {
        return -1000.0;
    }
    const double saw = z + 0.35 * y + 400.0;
    if (ellipse(x / 86, y / 62) < 1.0 && ellipse(x / 80, y / 56) > 1.0 && std::fmod(saw, 24.0) < 9.0) {
        return 400.0;
    }
    if (std::hypot(x, y - 44) < 13 && std::fmod(z + 400.0, 25.0) < 19.0) {
        return 350.0;
    }
    if (std::fabs(x) < 12 && y < -58 && y > -64 && z < 80) {
        return 350.0;
    }
    if (std::hypot(x, y - 18) < 8 && z > 20) {
        return -1000.0;
    }
    if (ellipse((x - 10) / 38, (y + 12) / 34, (z + 20) / 45) < 1.0) {
        return 45.0;
    }
    const double side = x > 0.0 ? 42.0 : -42.0;
    return ellipse((x - side) / 36, (y + 2) / 48, (z + 10) / 95) < 1.0 ? -850.0 : 40.0;
}

TEST(HeadFrame, VolumeWithoutHeadIsRefused) {
    const auto refused = [](const imaging::Volume& ct, const std::string& what) {
        try {
            const HeadFrame found = find_head(ct, {});
            ADD_FAILURE() << what << " is taken for a head: asymmetry " << found.asymmetry << ", misfit "
                          << found.misfit << ", vault " << found.vault;
        } catch (const imaging::VolumeError& error) {
            const std::string message = error.what();
            EXPECT_EQ(message.rfind("the volume shows no head", 0), 0u) << message;
            EXPECT_NE(message.find("Remedy: "), std::string::npos) << message;
        }
    };
    refused(drawn(chest), "a chest");
    Random random(1);
    refused(drawn([&](double, double, double) { return 600.0 * static_cast<double>(random.normal()); }),
            "noise");
    refused(drawn([&](double, double, double) {
                return 2000.0 * static_cast<double>(random.uniform()) - 1000.0;
            }),
            "even noise");
    const auto box = [](double x, double y, double z) {
        return std::max({std::fabs(x), std::fabs(y), std::fabs(z)});
    };
    refused(drawn([&](double x, double y, double z) { return box(x, y, z) < 60.0 ? 40.0 : -1000.0; }),
            "a box");
    const auto case_of_bone = [&](double x, double y, double z) {
        const double r = box(x, y, z);
        return r > 60.0 || r < 20.0 ? -1000.0 : r > 54.0 ? 500.0 : 40.0;
    };
    refused(drawn(case_of_bone), "a case of bone");
    const auto ball = [&](double x, double y, double z) {
        const double r = std::sqrt(x * x + y * y + z * z);
        const bool tube = std::hypot(x - 10.0, y) < 8.0 && z < 0.0;
        return r > 70.0 || tube ? -1000.0 : r > 56.0 && r < 62.0 ? 500.0 : 40.0;
    };
    refused(drawn(ball), "a hollow ball of bone");

    // One half of a head has no mirror image.
    const imaging::Volume& whole = coarse_phantom(2.0e-3f).ct;
    imaging::Volume half;
    half.geometry = whole.geometry;
    half.geometry.size[0] /= 2;
    for (std::size_t i = 0; i < whole.value.size(); ++i) {
        if (whole.geometry.coordinates(i)[0] < half.geometry.size[0]) {
            half.value.push_back(whole.value[i]);
        }
    }
    refused(half, "half a head");
}

}  // namespace
}  // namespace eti::segmentation
