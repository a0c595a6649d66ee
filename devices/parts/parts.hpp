// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/mesh/triangle_mesh.hpp"
#include "common/model/tools/tools.hpp"

namespace eti::devices {

/// Radius [m] of the ball at the printed blade's tip, and of the board's dimples: a ball in a dimple has its
/// centre at the dimple's named point.
inline constexpr float tip_ball_radius = 1e-3f;

/// Dimensions that depend on device and printer; measure with a caliper. All in m.
struct PartSettings {
    /// Of the stylus that the handle fits on: a quarter-inch plug (6.35 mm). Not verified for Touch and Touch
    /// X.
    float stylus_diameter = 6.5e-3f;
    float stylus_depth = 30e-3f;  ///< insertion depth; not verified
    /// Of the magnetic sensor: Ascension's type 180 is "1.8mm" in its ATC3DG.h; its sleeve is not verified.
    float sensor_diameter = 2.0e-3f;
    float sensor_length = 12e-3f;  ///< insertion depth
    float clearance = 0.15e-3f;    ///< of every bore, all round; depends on the printer
    float wall = 2.0e-3f;          ///< around bores
    float spacing = 0.4e-3f;       ///< of the grid used to extract the surface
};

/// Laryngoscope, in its tool frame: the model's three capsules, a ball of tip_ball_radius at the blade's tip,
/// and a bore from below along the handle for the stylus. Throws std::invalid_argument when the stylus leaves
/// the handle no wall.
[[nodiscard]] TriangleMesh laryngoscope_part(const Laryngoscope& scope, const PartSettings& settings);

/// Sleeve for the tube, in the tube's tool frame (grip at the origin, +z towards its tip): the tube passes
/// through; the sensor lies behind it in a bore closed at the front.
[[nodiscard]] TriangleMesh tube_connector_part(const Tube& tube, const PartSettings& settings);

/// Stepped board with a dimple at each point [m, patient frame]: points at one height share a step.
[[nodiscard]] TriangleMesh board_part(std::span<const Eigen::Vector3d> points, const PartSettings& settings);

/// Writes binary STL in millimetres (the format has no unit). Throws std::runtime_error on failure.
void write_stl(const TriangleMesh& mesh, const std::filesystem::path& file);

}  // namespace eti::devices
