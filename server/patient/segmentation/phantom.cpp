// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/phantom.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "common/math/random.hpp"
#include "common/math/units.hpp"
#include "server/parallel/loops.hpp"

namespace eti::segmentation {

namespace {

using anatomy::Fields;

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

/// How near [m] the closest border is; fields are distances only roughly.
float nearest_border(const Fields& f) {
    return std::min({std::fabs(f.skin), std::fabs(f.cavity), std::fabs(f.tongue), std::fabs(f.epiglottis),
                     std::fabs(f.skull), std::fabs(f.mandible), std::fabs(f.spine), std::fabs(f.hyoid)});
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
    const anatomy::Newborn newborn(settings.newborn);
    const float h = settings.spacing;
    auto [low, high] = newborn.bounds();
    const Vec3f margin(4.0f * millimetre, 4.0f * millimetre, 4.0f * millimetre);
    high += margin;
    low -= Vec3f(margin.x(), margin.y(), 0.0f);

    Phantom phantom;
    imaging::Geometry& geometry = phantom.ct.geometry;
    geometry.origin = low.cast<double>();
    geometry.step = static_cast<double>(h) * Eigen::Matrix3d::Identity();
    for (int k = 0; k < 3; ++k) {
        geometry.size[static_cast<std::size_t>(k)] = static_cast<int>(std::ceil((high[k] - low[k]) / h)) + 1;
    }
    imaging::require_sound(geometry, "phantom");
    phantom.labels.geometry = geometry;
    phantom.ct.value.resize(geometry.count());
    phantom.labels.value.resize(geometry.count());
    std::atomic<int> slices{0};
    std::atomic<bool> stop{false};
    parallel::for_each(geometry.size[2], 1, [&](int z) {
        if (stop) {
            return;
        }
        // Each slice has its own seed, so that the noise does not depend on who computes it when.
        Random random(settings.seed * 0x9e3779b97f4a7c15ULL + static_cast<std::uint64_t>(z));
        for (int y = 0; y < geometry.size[1]; ++y) {
            for (int x = 0; x < geometry.size[0]; ++x) {
                const Vec3f centre = geometry.point(x, y, z).cast<float>();
                const Fields f = newborn.fields(centre);
                Label label = label_of(f);
                float value = hounsfield_of(label);
                if (nearest_border(f) < 1.2f * h) {
                    std::array<int, label_count> share{};
                    value = 0.0f;
                    for (int s = 0; s < 27; ++s) {
                        const Vec3f offset(static_cast<float>(s % 3 - 1), static_cast<float>(s / 3 % 3 - 1),
                                           static_cast<float>(s / 9 - 1));
                        const Label part = label_of(newborn.fields(centre + h / 3.0f * offset));
                        ++share[value_of(part)];
                        value += hounsfield_of(part) / 27.0f;
                    }
                    label = static_cast<Label>(std::max_element(share.begin(), share.end()) - share.begin());
                }
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
        throw Stopped();
    }
    const auto landmarks = newborn.landmarks();
    for (std::size_t i = 0; i < landmark_count; ++i) {
        phantom.landmarks[std::string(landmark_names[i])] = {landmarks[i].cast<double>()};
    }
    return phantom;
}

}  // namespace eti::segmentation
