// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <span>

#include "common/mesh/triangle_mesh.hpp"
#include "common/process/guard.hpp"
#include "server/patient/imaging/bytes.hpp"

namespace eti::imaging {

/// Reads a surface from STL (text or binary), Wavefront OBJ or PLY (text or binary), in millimetres.
/// Coincident corners become one vertex, polygons become triangles. LPS, unless a comment contains SPACE=RAS,
/// as written by 3D Slicer. `name` is used in errors; its extension selects the format. Throws VolumeError
/// naming file, finding, expectation and remedy.
[[nodiscard]] TriangleMesh parse_mesh(std::span<const std::uint8_t> data, const std::string& name);

/// Runs parse_mesh() on a file in a child process with bounded time and memory. [m], LPS.
[[nodiscard]] TriangleMesh read_mesh(const std::filesystem::path& path, const GuardLimits& limits = {});

}  // namespace eti::imaging
