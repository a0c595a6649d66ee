// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/phantom.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "common/math/random.hpp"
#include "common/math/units.hpp"
#include "server/parallel/loops.hpp"

namespace eti::segmentation {

namespace {

using patient::Fields;

Label label_of(const Fields& f) {
    if (f.skin > 0.0f) {
        return Label::outside;
    }
    if (f.cavity < 0.0f && f.tongue > 0.0f && f.epiglottis > 0.0f) {
        return Label::airway;
    }
    const float bone = std::min({f.skull, f.mandible, f.spine, f.hyoid});
    if (bone < 0.0f) {
        return bone == f.mandible ? Label::mandible : bone == f.spine ? Label::spine : Label::bone;
    }
    if (f.epiglottis < 0.0f) {
        return Label::epiglottis;
    }
    return f.tongue < 0.0f ? Label::tongue : Label::soft;
}

/// Distance [m] to the nearest border; approximate, as are the fields.
float nearest_border(const Fields& f) {
    return std::min({std::fabs(f.skin), std::fabs(f.cavity), std::fabs(f.tongue), std::fabs(f.epiglottis),
                     std::fabs(f.skull), std::fabs(f.mandible), std::fabs(f.spine), std::fabs(f.hyoid)});
}

/// Voxels along the edge of the cubes that are tested as a whole first.
constexpr int cube = 4;
/// Distance of a cube's centre from a border, at which all its voxels have one label [spacings]: twice the
/// distance to the farthest of them plus the range of fine sampling, because fields are approximate
/// distances.
constexpr float clear_of_borders = 2.0f * (0.5f * (cube - 1) * 1.7321f + 1.2f);

/// The label of all voxels of a cube; empty where a border may cross it. Cubes are ordered like voxels.
std::vector<std::optional<Label>> labels_of_cubes(const patient::Newborn& newborn,
                                                  const imaging::Geometry& geometry,
                                                  const std::array<int, 3>& cubes) {
    const float h = static_cast<float>(geometry.step(0, 0));
    const Vec3f to_middle = (geometry.step * Vec3d::Constant(0.5 * (cube - 1))).cast<float>();
    // The far corner of a cube; farther where a tilted gantry shears it.
    const float clear =
        clear_of_borders * h * std::max(1.0f, to_middle.norm() / (0.5f * (cube - 1) * 1.7321f * h));
    std::vector<std::optional<Label>> labels(static_cast<std::size_t>(cubes[0]) * cubes[1] * cubes[2]);
    parallel::for_each(cubes[2], 1, [&](int z) {
        auto label = labels.begin() + static_cast<std::ptrdiff_t>(z) * cubes[0] * cubes[1];
        for (int y = 0; y < cubes[1]; ++y) {
            for (int x = 0; x < cubes[0]; ++x, ++label) {
                const Fields f =
                    newborn.fields(geometry.point(cube * x, cube * y, cube * z).cast<float>() + to_middle);
                if (nearest_border(f) > clear) {
                    *label = label_of(f);
                }
            }
        }
    });
    return labels;
}

/// The majority label of a voxel and its mean radiodensity [HU].
std::pair<Label, float> voxel_at(const patient::Newborn& newborn, const Vec3f& centre, float h) {
    const Fields f = newborn.fields(centre);
    if (nearest_border(f) >= 1.2f * h) {
        return {label_of(f), hounsfield_of(label_of(f))};
    }
    std::array<int, label_count> share{};
    float value = 0.0f;
    for (int s = 0; s < 27; ++s) {
        const Vec3f offset(static_cast<float>(s % 3 - 1), static_cast<float>(s / 3 % 3 - 1),
                           static_cast<float>(s / 9 - 1));
        const Label part = label_of(newborn.fields(centre + h / 3.0f * offset));
        ++share[value_of(part)];
        value += hounsfield_of(part) / 27.0f;
    }
    return {static_cast<Label>(std::max_element(share.begin(), share.end()) - share.begin()), value};
}

}  // namespace

float hounsfield_of(Label label) {
    switch (label) {
        case Label::outside:
        case Label::airway:
        case Label::enclosed_air:
            return -1000.0f;
        case Label::bone:
        case Label::mandible:
        case Label::spine:
            return 420.0f;
        case Label::tongue:
            return 58.0f;
        case Label::epiglottis:
            return 44.0f;
        case Label::soft:
            break;
    }
    return 40.0f;
}

Phantom make_phantom(const PhantomSettings& settings, const Progress& progress) {
    const patient::Newborn newborn(settings.newborn);
    const float h = settings.spacing;
    auto [low, high] = newborn.bounds();
    const Vec3f margin(4.0f * millimetre, 4.0f * millimetre, 4.0f * millimetre);
    high += margin;
    low -= Vec3f(margin.x(), margin.y(), 0.0f);

    Phantom phantom;
    imaging::Geometry& geometry = phantom.ct.geometry;
    geometry.origin = low.cast<double>();
    // The slices' normal is inclined, the couch is not: their distance along the normal remains the spacing.
    const double cosine = std::cos(static_cast<double>(settings.gantry_tilt));
    geometry.step = static_cast<double>(h) * Eigen::Matrix3d::Identity();
    geometry.step.col(1) =
        static_cast<double>(h) * Vec3d(0.0, cosine, std::sin(static_cast<double>(settings.gantry_tilt)));
    geometry.step.col(2) = static_cast<double>(h) / cosine * Vec3d::UnitZ();
    for (int k = 0; k < 3; ++k) {
        geometry.size[static_cast<std::size_t>(k)] =
            static_cast<int>(std::ceil((high[k] - low[k]) / static_cast<float>(geometry.step(k, k)))) + 1;
    }
    imaging::require_valid(geometry, "phantom");
    phantom.labels.geometry = geometry;
    phantom.ct.value.resize(geometry.count());
    phantom.labels.value.resize(geometry.count());
    std::array<int, 3> cubes{};
    std::transform(geometry.size.begin(), geometry.size.end(), cubes.begin(),
                   [](int size) { return (size + cube - 1) / cube; });
    const auto of_cube = labels_of_cubes(newborn, geometry, cubes);
    std::atomic<int> slices{0};
    std::atomic<bool> stop{false};
    parallel::for_each(geometry.size[2], 1, [&](int z) {
        if (stop) {
            return;
        }
        // Each slice has its own seed, so that the noise does not depend on the order of computation.
        Random random(settings.seed * 0x9e3779b97f4a7c15ULL + static_cast<std::uint64_t>(z));
        for (int y = 0; y < geometry.size[1]; ++y) {
            for (int x = 0; x < geometry.size[0]; ++x) {
                const auto& whole = of_cube[x / cube + cubes[0] * (y / cube + cubes[1] * (z / cube))];
                const auto [label, value] = whole
                                                ? std::pair(*whole, hounsfield_of(*whole))
                                                : voxel_at(newborn, geometry.point(x, y, z).cast<float>(), h);
                const std::size_t i = geometry.index(x, y, z);
                phantom.labels.value[i] = value_of(label);
                phantom.ct.value[i] = std::round(value + settings.noise * random.normal());
            }
        }
        if (!progress(static_cast<float>(++slices) / static_cast<float>(geometry.size[2]),
                      "sampling the newborn")) {
            stop = true;
        }
    });
    if (stop) {
        throw CancelledError();
    }
    const auto landmarks = newborn.landmarks();
    for (std::size_t i = 0; i < landmark_count; ++i) {
        phantom.landmarks[std::string(landmark_names[i])] = {landmarks[i].cast<double>()};
    }
    return phantom;
}

}  // namespace eti::segmentation
