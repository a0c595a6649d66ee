// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <array>
#include <utility>

#include "server/patient/newborn/build.hpp"

namespace eti::anatomy {

namespace {

/// Weights of which `frame` has `share` and the others the rest, as they had it; the least of five goes.
SkinWeights shared_with(const SkinWeights& skin, std::uint16_t frame, float share) {
    std::array<std::pair<float, std::uint16_t>, 5> all{};
    for (std::size_t k = 0; k < 4; ++k) {
        all[k] = {(1.0f - share) * skin.weight[k], skin.frame[k]};
    }
    all[4] = {share, frame};
    std::ranges::stable_sort(all, [](const auto& a, const auto& b) { return a.first > b.first; });
    SkinWeights out;
    const float kept = 1.0f - all[4].first;
    for (std::size_t k = 0; k < 4; ++k) {
        out.weight[k] = all[k].first / kept;
        out.frame[k] = all[k].second;
    }
    return out;
}

}  // namespace

void hang_folds(const Anatomy& anatomy, Patient& patient) {
    const auto plate = std::ranges::find(patient.clusters.tissue, Tissue::epiglottis);
    if (plate == patient.clusters.tissue.end()) {
        return;
    }
    const auto frame = static_cast<std::uint16_t>(
        bone_count + static_cast<std::size_t>(plate - patient.clusters.tissue.begin()));
    for (Surface& surface : patient.surfaces) {
        if (surface.tissue != Tissue::soft) {
            continue;
        }
        for (std::size_t i = 0; i < surface.skin.size(); ++i) {
            const float share = anatomy.hangs_on_epiglottis(surface.mesh.vertices[i]);
            if (share > 0.0f) {
                surface.skin[i] = shared_with(surface.skin[i], frame, share);
            }
        }
    }
}

}  // namespace eti::anatomy
