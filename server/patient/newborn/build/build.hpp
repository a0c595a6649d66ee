// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <compare>
#include <span>
#include <vector>

#include "common/model/newborn_shape.hpp"
#include "server/patient/model/model_file.hpp"
#include "server/patient/model/patient.hpp"
#include "server/patient/newborn/anatomy.hpp"

namespace eti::patient {

/// Resolution of particles and surfaces. Lengths are for a 3.5 kg newborn and scale with the patient, so that
/// a premature airway keeps its particle count.
struct BuildSettings {
    float spacing = 2.0e-3f;       ///< [m], particles of the bulk
    float fine_spacing = 1.0e-3f;  ///< [m], particles of epiglottis and larynx
    float region = 7.0e-3f;        ///< [m], tissue farther from the airway is rigidly bound to bone
    /// The epiglottis as a plate of its own (epiglottis_plate.hpp) instead of on the lattice: under trial,
    /// see docs/decisions/epiglottis.md.
    bool plate = false;
    /// [Pa], Young's modulus of tongue and mucosa. Measured tissue has 8.0 +- 0.9 kPa (Cheng 2011, J Biomech
    /// 44:450). The floor of the mouth is as soft as the tongue that is pressed into it
    /// (docs/decisions/airway-shell.md).
    float tissue_stiffness = 8e3f;
    /// [m], edge length of drawn surfaces in mouth and throat; finer at larynx and lips, coarser at trunk and
    /// scalp, in proportion. Bones are sampled 1.5 times as coarsely.
    float surface_spacing = 1.0e-3f;
    std::size_t body_triangles = 90000;
    std::size_t shell_triangles = 12000;
};

/// Builds a whole model: particles, clusters, links, surfaces, shell, landmarks. Takes some ten seconds on
/// two cores, of which surfaces and shell take all but one. They are copied from `surface_source`, if given:
/// a model of the same anatomy with equal surface_provenance().
[[nodiscard]] Patient build_patient(const Anatomy& anatomy, const BuildSettings& settings,
                                    const Patient* surface_source = nullptr);
/// The same for the parametric newborn.
[[nodiscard]] Patient build_patient(const NewbornShape& shape, const BuildSettings& settings,
                                    const Patient* surface_source = nullptr);

/// Everything that a model depends on: the building program, its settings, and the newborn's shape.
[[nodiscard]] Provenance provenance_of(const NewbornShape& shape, const BuildSettings& settings);
[[nodiscard]] Provenance provenance_of(const BuildSettings& settings);
/// The part that surfaces and shell depend on: without particle spacing and stiffness.
[[nodiscard]] Provenance surface_provenance(Provenance provenance);

/// A particle's place on one of the lattices; elements join neighbours on the same lattice.
struct LatticePlace {
    int lattice = 0;
    std::array<int, 3> index{};  ///< along right-handed axes
    auto operator<=>(const LatticePlace&) const = default;
};

// Stages of build_patient(), each adding its part of the model; set_tissue_stiffness() then sets the
// stiffness.
[[nodiscard]] std::vector<LatticePlace> build_particles(const Anatomy& anatomy, const BuildSettings& settings,
                                                        Patient& patient);
void build_clusters(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient);
void build_tetrahedra(std::span<const LatticePlace> places, Patient& patient);
void build_links(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient);
void build_frames(Patient& patient);
void build_surfaces(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient);
void skin_surfaces(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient);
void build_shell(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient);
void build_landmarks(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient);

/// Groups of tissues that share clusters and tetrahedra: 0 body, 1 tongue, 2 epiglottis.
[[nodiscard]] constexpr int family_of(Tissue tissue) {
    return tissue == Tissue::tongue ? 1 : tissue == Tissue::epiglottis ? 2 : 0;
}

}  // namespace eti::patient
