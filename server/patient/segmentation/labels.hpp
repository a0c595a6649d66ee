// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/math/transform.hpp"

namespace eti::segmentation {

/// Class of a voxel. Values are stored in files: append, never renumber.
enum class Label : std::uint8_t {
    outside,  ///< air around the patient, couch
    soft,     ///< soft tissue without a label of its own
    bone,     ///< skull with upper jaw, and any bone other than mandible and spine
    airway,   ///< lumen of nose, mouth, pharynx, larynx, trachea; also an air-filled gullet
    mandible,
    spine,
    tongue,
    epiglottis,    ///< in phantoms only; CT does not show its border
    enclosed_air,  ///< air cells and sinuses not connected to the airway
};
inline constexpr std::size_t label_count = 9;
inline constexpr std::array<std::string_view, label_count> label_names = {
    "outside", "soft tissue", "bone", "airway", "mandible", "spine", "tongue", "epiglottis", "enclosed air"};

/// The label of a structure by a name that contains its word ("Mandible left", "skin.stl"), in any case; the
/// most specific word counts. Empty if there is none.
[[nodiscard]] std::optional<Label> label_named(std::string_view name);

[[nodiscard]] constexpr std::uint8_t value_of(Label label) {
    return static_cast<std::uint8_t>(label);
}

/// Named points [m], LPS; a name may have several.
using Points = std::map<std::string, std::vector<Vec3d>>;

/// Progress callback of long operations: fraction done [0, 1] and current activity; returns false to cancel.
using Progress = std::function<bool(float, std::string_view)>;

/// The user cancelled; nothing was written.
class CancelledError : public std::runtime_error {
  public:
    CancelledError() : std::runtime_error("interrupted; nothing was written") {}
};

}  // namespace eti::segmentation
