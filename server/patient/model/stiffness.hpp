// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>

#include "server/patient/model/patient.hpp"

namespace eti::patient {

// Stiffness of a model's parts for Young's modulus `soft` [Pa] of tongue and mucosa. It depends on tissue and
// position only, so that stiffness changes without rebuilding the model.

/// Young's modulus [Pa]; that of cartilage is the same in every patient.
[[nodiscard]] float youngs_modulus_of(Tissue tissue, float soft);
/// Young's modulus [Pa].
[[nodiscard]] float cluster_modulus(const Patient& patient, std::uint32_t cluster, float soft);
/// Young's modulus [Pa], mean over an element's corners.
[[nodiscard]] float mean_modulus(const Patient& patient, std::span<const std::uint32_t> particles,
                                 float soft);
[[nodiscard]] float tetrahedron_modulus(const Patient& patient, std::uint32_t tetrahedron, float soft);
/// Stiffness [N/m]. A link between tongue and floor of the mouth represents a column of tissue with a
/// cross-section of one spacing squared: E h^2 / h.
[[nodiscard]] float link_stiffness(const Patient& patient, std::uint32_t link, float soft);

/// Sets the modulus of tongue and mucosa to `soft` [Pa], and updates all parts accordingly.
void set_tissue_stiffness(Patient& patient, float soft);

}  // namespace eti::patient
