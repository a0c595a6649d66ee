// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/patient/model/patient.hpp"

namespace eti::patient {

/// A mesh of whole lattice cells, and of tetrahedra where the surface cuts cells.
struct Cells {
    std::vector<std::array<std::uint32_t, 8>> hexahedra;   ///< corner bits x, y, z of the cell's axes
    std::vector<std::array<std::uint32_t, 4>> tetrahedra;  ///< of the other cells
};

/// Joins tetrahedra of the patient, given by ascending index, to whole cells: those five in a row that
/// build_tetrahedra() cut from one.
[[nodiscard]] Cells cells_of(std::span<const std::uint32_t> tetrahedra, const Patient& patient);

}  // namespace eti::patient
