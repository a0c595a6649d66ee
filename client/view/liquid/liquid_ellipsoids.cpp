// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/liquid/liquid_ellipsoids.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/math/smoothstep.hpp"

namespace eti::view {
namespace {

constexpr float reach = 1.75f;        // [spacings], of the kernel: the 26 neighbours of a cubic lattice
constexpr float smoothing = 0.9f;     // of the centre towards the neighbours' mean; Yu and Turk use 0.9 to 1
constexpr float bulk_sigma = 0.692f;  // [spacings], standard deviation along each axis within a cubic lattice
// Sum of the neighbours' weights: up to the first the particle is a drop, from the second on part of a
// surface. A flat square lattice has 5.1.
constexpr float separate = 1.0f, surrounded = 4.5f;

}  // namespace

float LiquidEllipsoid::volume() const {
    return 4.0f / 3.0f * std::numbers::pi_v<float> * radii.prod();
}

void LiquidEllipsoids::fit(std::span<const Vec3f> positions, float spacing) {
    const float farthest = reach * spacing;
    cells_.fill(positions, farthest);
    ellipsoids_.resize(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        // Sums of weights, offsets and their products; the particle itself has offset 0 and weight 1.
        float weights = 1.0f;
        Vec3f offsets = Vec3f::Zero();
        Mat3f products = Mat3f::Zero();
        cells_.visit_near(positions[i], [&](std::uint32_t k) {
            const Vec3f offset = positions[k] - positions[i];
            const float squared = offset.squaredNorm();
            if (k == i || squared >= farthest * farthest) {
                return;
            }
            const float share = std::sqrt(squared) / farthest;
            const float weight = 1.0f - share * share * share;
            weights += weight;
            offsets += weight * offset;
            products += (weight * offset) * offset.transpose();
        });
        const float joined = smoothstep(separate, surrounded, weights - 1.0f);
        LiquidEllipsoid& shape = ellipsoids_[i];
        shape = {positions[i], Vec3f::Constant(alone * spacing), Quatf::Identity()};
        if (joined <= 0.0f) {
            continue;
        }
        const Vec3f mean = offsets / weights;
        Eigen::SelfAdjointEigenSolver<Mat3f> axes;
        axes.computeDirect(products / weights - mean * mean.transpose());
        Mat3f directions = axes.eigenvectors();
        if (directions.determinant() < 0.0f) {
            directions.col(0) = -directions.col(0);
        }
        shape.centre += joined * smoothing * mean;
        shape.rotation = Quatf(directions).normalized();
        for (int axis = 0; axis < 3; ++axis) {
            const float sigma = std::sqrt(std::max(axes.eigenvalues()[axis], 0.0f));
            const float radius = std::clamp(sigma / bulk_sigma, thinnest * spacing, widest * spacing);
            shape.radii[axis] = std::lerp(alone * spacing, radius, joined);
        }
    }
}

}  // namespace eti::view
