// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/placement/registration.hpp"

#include <fmt/format.h>
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "common/math/units.hpp"
#include "common/mesh/isosurface.hpp"
#include "server/patient/newborn/newborn.hpp"
#include "server/patient/segmentation/grids/label_distance.hpp"

namespace eti::segmentation {

namespace {

constexpr double registration_spacing = 1.0e-3;  // [m], sampling grid of the newborn
constexpr float reference_weight = 3.5f;         // [kg]
constexpr float sample_spacing = 2.5e-3f;
constexpr float huber = 3e-3f;  // [m]; beyond it, points count linearly
constexpr std::size_t parts = 4;
constexpr int search_rounds = 12;  // per start
constexpr int settling_rounds = 40;

struct Part {
    std::vector<Vec3f> points;  // [m], patient frame of the reference newborn
    DistanceGrid labels;
};

/// Points on the newborn's surface where `field` is zero.
template <class Field>
std::vector<Vec3f> surface_points(const patient::Newborn& newborn, const Vec3f& low, const Vec3f& high,
                                  const Field& field) {
    DistanceGrid grid;
    grid.origin = low;
    grid.spacing = sample_spacing;
    for (int k = 0; k < 3; ++k) {
        grid.size[static_cast<std::size_t>(k)] = static_cast<int>((high[k] - low[k]) / sample_spacing) + 2;
    }
    grid.value.resize(static_cast<std::size_t>(grid.size[0]) * grid.size[1] * grid.size[2]);
    for (int z = 0; z < grid.size[2]; ++z) {
        for (int y = 0; y < grid.size[1]; ++y) {
            for (int x = 0; x < grid.size[0]; ++x) {
                grid.value[grid.index(x, y, z)] = field(newborn.fields(grid.node(x, y, z)));
            }
        }
    }
    std::vector<Vec3f> points = isosurface(grid, 0.0f, Border::open).vertices;
    // The grid is coarse relative to the surface's curvature: two Newton steps along the gradient.
    constexpr float h = 0.2e-3f;
    for (Vec3f& p : points) {
        for (int step = 0; step < 2; ++step) {
            Vec3f slope;
            for (int k = 0; k < 3; ++k) {
                const Vec3f off = h * Vec3f::Unit(k);
                slope[k] = (field(newborn.fields(p + off)) - field(newborn.fields(p - off))) / (2.0f * h);
            }
            const Vec3f move = field(newborn.fields(p)) / std::max(slope.squaredNorm(), 0.1f) * slope;
            p -= move.norm() < sample_spacing ? move : Vec3f::Zero();
        }
    }
    return points;
}

struct Similarity {
    float scale = 1.0f;
    RigidTransform place;
    [[nodiscard]] Vec3f operator*(const Vec3f& p) const { return place * Vec3f(scale * p); }
};

struct Fit {
    Similarity similarity;
    double cost = std::numeric_limits<double>::max();
    double off = 0.0;  // [m]
};

/// Distance and Huber weight: the influence of distant points is bounded.
void accumulate(const std::array<Part, parts>& all, const Similarity& at,
                Eigen::Matrix<double, 7, 7>& squares, Eigen::Matrix<double, 7, 1>& pull, Fit& fit) {
    squares.setZero();
    pull.setZero();
    double cost = 0.0;
    double sum = 0.0;
    double count = 0.0;
    for (const Part& part : all) {
        if (part.points.empty()) {
            continue;
        }
        const double share = 1.0 / static_cast<double>(part.points.size());
        for (const Vec3f& p : part.points) {
            const Vec3f moved = at * p;
            const DistanceSample s = part.labels.sample(moved);
            const float size = std::fabs(s.distance);
            const double weight = share * static_cast<double>(size > huber ? huber / size : 1.0f);
            cost += share * static_cast<double>(size > huber ? huber * (2.0f * size - huber) : size * size);
            sum += share * static_cast<double>(size);
            const Vec3f arm = moved - at.place.translation;
            const Vec3f turn = arm.cross(s.normal);
            Eigen::Matrix<double, 7, 1> row;
            row << s.normal.cast<double>(), turn.cast<double>(), static_cast<double>(arm.dot(s.normal));
            squares += weight * row * row.transpose();
            pull -= weight * static_cast<double>(s.distance) * row;
        }
        count += 1.0;
    }
    fit.cost = cost;
    fit.off = sum / count;
    fit.similarity = at;
}

Fit improve(const std::array<Part, parts>& all, Similarity at, int rounds) {
    Eigen::Matrix<double, 7, 7> squares;
    Eigen::Matrix<double, 7, 1> pull;
    Fit best;
    for (int round = 0; round < rounds; ++round) {
        Fit fit;
        accumulate(all, at, squares, pull, fit);
        if (fit.cost < best.cost) {
            best = fit;
        }
        squares.diagonal().array() += 1e-9 + 1e-3 * squares.diagonal().array();
        const Eigen::Matrix<double, 7, 1> step = squares.ldlt().solve(pull);
        const Vec3f turn = step.segment<3>(3).cast<float>();
        const float angle = turn.norm();
        if (angle > 1e-9f) {
            at.place.rotation =
                (Quatf(Eigen::AngleAxisf(std::min(angle, 0.2f), turn / angle)) * at.place.rotation)
                    .normalized();
        }
        at.place.translation += step.head<3>().cast<float>();
        at.scale *= std::exp(std::clamp(static_cast<float>(step[6]), -0.1f, 0.1f));
        at.scale = std::clamp(at.scale, 0.4f, 3.0f);
    }
    return best;
}

}  // namespace

Registration register_newborn(const imaging::Mask& given) {
    const imaging::Mask labels = upright_labels(given, registration_spacing);
    const imaging::Geometry& g = labels.geometry;
    NewbornShape shape;
    shape.weight = reference_weight;
    const patient::Newborn newborn(shape);
    const auto [low, high] = newborn.airway_bounds();
    const Vec3f wide_low(low.x() - 15e-3f, low.y(), low.z());
    const Vec3f wide_high(high.x() + 15e-3f, high.y() + 15e-3f, high.z() + 12e-3f);
    std::array<Part, parts> all;
    const auto add = [&](std::size_t k, std::initializer_list<Label> which, const auto& field) {
        const imaging::Bits member = select(labels, which);
        if (std::find(member.begin(), member.end(), 1) == member.end()) {
            return false;
        }
        all[k] = {surface_points(newborn, wide_low, wide_high, field), distance_of(g, member)};
        return true;
    };
    const bool air = add(0, {Label::airway}, [](const patient::Fields& f) {
        return std::max({f.cavity, -f.tongue, -f.epiglottis});
    });
    const bool jaw = add(1, {Label::mandible}, [](const patient::Fields& f) { return f.mandible; });
    add(2, {Label::tongue}, [](const patient::Fields& f) { return f.tongue; });
    add(3, {Label::spine}, [](const patient::Fields& f) { return f.spine; });
    if (!air || !jaw) {
        throw NoLarynxError(fmt::format(
            "the labels show no {}; without it the larynx cannot be placed. Remedy: use a CT that reaches "
            "from the palate to below the larynx, or labels with airway (3) and mandible (4)",
            !jaw ? "mandible" : "airway"));
    }
    Box bone;
    for (std::size_t i = 0; i < labels.value.size(); ++i) {
        if (labels.value[i] == value_of(Label::mandible)) {
            const auto [x, y, z] = g.coordinates(i);
            bone.add(g.point(x, y, z));
        }
    }
    Vec3f centre = Vec3f::Zero();
    Vec3f reach_low = Vec3f::Constant(1.0f), reach_high = Vec3f::Constant(-1.0f);
    for (const Vec3f& p : all[1].points) {
        reach_low = reach_low.cwiseMin(p);
        reach_high = reach_high.cwiseMax(p);
    }
    centre = 0.5f * (reach_low + reach_high);
    const Vec3f middle = (0.5 * (bone.low + bone.high)).cast<float>();
    Similarity start;
    start.scale = static_cast<float>((bone.high - bone.low).x()) / (reach_high - reach_low).x();
    Fit best;
    for (const float tilt_deg : {0.0f, -20.0f, 20.0f, -40.0f, 40.0f}) {
        start.place.rotation = Quatf(Eigen::AngleAxisf(tilt_deg * degree, Vec3f::UnitX()));
        start.place.translation = middle - start.place.rotation * Vec3f(start.scale * centre);
        const Fit fit = improve(all, start, search_rounds);
        if (fit.cost < best.cost) {
            best = fit;
        }
    }
    best = improve(all, best.similarity, settling_rounds);
    const float scale = best.similarity.scale;
    return {reference_weight * scale * scale * scale, best.similarity.place, best.off};
}

}  // namespace eti::segmentation
