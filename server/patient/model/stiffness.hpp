// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>

#include "server/patient/model/patient.hpp"

namespace eti::anatomy {

// How stiff each part of a model is where tongue and mucosa have Young's modulus `soft` [Pa]. It follows from
// the parts' tissues and places alone, so that stiffness changes without building a model anew.

/// [Pa]; of cartilage the same in every patient.
[[nodiscard]] float youngs_modulus_of(Tissue tissue, float soft);
/// [Pa]
[[nodiscard]] float cluster_modulus(const Patient& patient, std::uint32_t cluster, float soft);
/// [Pa], mean over the corners.
[[nodiscard]] float tetrahedron_modulus(const Patient& patient, std::uint32_t tetrahedron, float soft);
/// [N/m]. Between tongue and floor of the mouth a link stands for a column of tissue of one spacing squared:
/// E h^2 / h.
[[nodiscard]] float link_stiffness(const Patient& patient, std::uint32_t link, float soft);

/// Gives tongue and mucosa the modulus `soft` [Pa], and all parts what follows from it.
void set_tissue_stiffness(Patient& patient, float soft);

}  // namespace eti::anatomy
