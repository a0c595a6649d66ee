// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/model/newborn_shape.hpp"
#include "server/patient/model/model_file.hpp"
#include "server/patient/model/patient.hpp"
#include "server/patient/newborn/anatomy.hpp"

namespace eti::anatomy {

/// How finely the patient is cut into particles and triangles. Lengths are those of a 3.5 kg
/// newborn and shrink with the patient, so that a premature airway keeps its particle count.
struct BuildSettings {
    float spacing = 2.0e-3f;       ///< [m], particles of the bulk
    float fine_spacing = 1.0e-3f;  ///< [m], particles of epiglottis and larynx
    float region = 7.0e-3f;        ///< [m], tissue farther from the airway moves with the bones
    /// [Pa], Young's modulus of tongue and mucosa. Measured tissue has 8.0 +- 0.9 kPa (Cheng 2011, J Biomech
    /// 44:450), but here the mouth's floor cannot give way as a whole
    /// (docs/decisions/airway-shell.md).
    float tissue_stiffness = 8e3f;
    /// [m], edges of what is drawn in mouth and throat; finer at larynx and lips, coarser at trunk and scalp,
    /// in proportion. Bones are sampled 1.5 times as wide.
    float surface_spacing = 1.0e-3f;
    std::size_t body_triangles = 70000;
    std::size_t shell_triangles = 12000;
};

/// Builds a whole model: particles, clusters, links, surfaces, shell, landmarks. Some ten seconds on two
/// cores, of which surfaces and shell take all but one: `formed`, a model of the same anatomy and form_of()
/// the same settings, lends them.
[[nodiscard]] Patient build_patient(const Anatomy& anatomy, const BuildSettings& settings,
                                    const Patient* formed = nullptr);
/// The same of the parametric newborn.
[[nodiscard]] Patient build_patient(const NewbornShape& shape, const BuildSettings& settings,
                                    const Patient* formed = nullptr);

/// What a model depends on: the program that built it and how, and of the newborn its shape.
[[nodiscard]] Provenance provenance_of(const NewbornShape& shape, const BuildSettings& settings);
[[nodiscard]] Provenance provenance_of(const BuildSettings& settings);
/// Of these, what surfaces and shell depend on: not how the tissue is cut into particles, nor how stiff it
/// is.
[[nodiscard]] Provenance form_of(Provenance provenance);

// The steps of build_patient, each adding its part of the model; set_tissue_stiffness() makes them as stiff
// as they shall be.
void build_particles(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient);
void build_clusters(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient);
void build_tetrahedra(const Anatomy& anatomy, Patient& patient);
void build_links(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient);
void build_frames(Patient& patient);
void build_surfaces(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient);
void skin_surfaces(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient);
void build_shell(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient);
void build_landmarks(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient);

/// Tissues that share clusters and tetrahedra: 0 body, 1 tongue, 2 epiglottis.
[[nodiscard]] constexpr int family_of(Tissue tissue) {
    return tissue == Tissue::tongue ? 1 : tissue == Tissue::epiglottis ? 2 : 0;
}

}  // namespace eti::anatomy
