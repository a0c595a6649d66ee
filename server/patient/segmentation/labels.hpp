// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/math/transform.hpp"

namespace eti::segmentation {

/// What a voxel belongs to. Values go into files: append, never renumber.
enum class Label : std::uint8_t {
    outside,  ///< air around the patient, couch
    soft,     ///< soft tissue that has no label of its own
    bone,     ///< skull with upper jaw, and any bone that is neither mandible nor spine
    airway,   ///< lumen of nose, mouth, pharynx, larynx, trachea; an air-filled gullet too
    mandible,
    spine,
    tongue,
    epiglottis,    ///< in phantoms; CT does not show its border
    enclosed_air,  ///< air cells and sinuses that do not open into the airway
};
inline constexpr std::size_t label_count = 9;
inline constexpr std::array<std::string_view, label_count> label_names = {
    "outside", "soft tissue", "bone", "airway", "mandible", "spine", "tongue", "epiglottis", "enclosed air"};

[[nodiscard]] constexpr std::uint8_t value_of(Label label) {
    return static_cast<std::uint8_t>(label);
}

/// Named points [m], LPS; a name may have several.
using Points = std::map<std::string, std::vector<Vec3d>>;

/// Callback of long work: the share done [0, 1] and what is being done; false asks to stop.
using Progress = std::function<bool(float, std::string_view)>;

/// The person asked to stop; nothing was written.
class Stopped : public std::runtime_error {
  public:
    Stopped() : std::runtime_error("stopped; nothing was written") {}
};

}  // namespace eti::segmentation
