// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/model/stiffness.hpp"

#include <algorithm>

namespace eti::patient {

namespace {

constexpr float ligament = 20.0f;  // [N/m], of each link of the hyoepiglottic ligament

}  // namespace

float youngs_modulus_of(Tissue tissue, float soft) {
    switch (tissue) {
        case Tissue::epiglottis:
            return 320e3f;  // elastic cartilage
        case Tissue::larynx:
            return 32e3f;  // cartilage and cords as one
        default:
            return soft;
    }
}

float cluster_modulus(const Patient& patient, std::uint32_t cluster, float soft) {
    return youngs_modulus_of(patient.clusters.tissue[cluster], soft);
}

float mean_modulus(const Patient& patient, std::span<const std::uint32_t> particles, float soft) {
    const float share = 1.0f / static_cast<float>(particles.size());
    float modulus = 0.0f;
    for (const std::uint32_t i : particles) {
        modulus += share * youngs_modulus_of(patient.particles.tissue[i], soft);
    }
    return modulus;
}

float tetrahedron_modulus(const Patient& patient, std::uint32_t tetrahedron, float soft) {
    return mean_modulus(patient, patient.tetrahedra.corners[tetrahedron], soft);
}

float link_stiffness(const Patient& patient, std::uint32_t link, float soft) {
    const auto& ends = patient.links.ends[link];
    const auto joins = [&](Tissue tissue) {
        return std::ranges::any_of(ends,
                                   [&](std::uint32_t i) { return patient.particles.tissue[i] == tissue; });
    };
    if (joins(Tissue::epiglottis) && joins(Tissue::tongue)) {
        return ligament;
    }
    // An attachment has the stiffness of a particle there: E A / l.
    const float modulus = joins(Tissue::epiglottis) ? youngs_modulus_of(Tissue::larynx, soft) : soft;
    return modulus * 2.0f * patient.particles.radius[ends[0]];
}

void set_tissue_stiffness(Patient& patient, float soft) {
    patient.tissue_stiffness = soft;
    const auto fill = [&](std::vector<float>& values, std::size_t count, auto of) {
        values.resize(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            values[i] = of(patient, i, soft);
        }
    };
    fill(patient.clusters.youngs_modulus, patient.clusters.size(), cluster_modulus);
    fill(patient.tetrahedra.youngs_modulus, patient.tetrahedra.corners.size(), tetrahedron_modulus);
    fill(patient.links.stiffness, patient.links.ends.size(), link_stiffness);
}

}  // namespace eti::patient
