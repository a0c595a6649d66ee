// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <span>

#include "common/mesh/triangle_mesh.hpp"
#include "common/process/guard.hpp"
#include "server/patient/imaging/bytes.hpp"

namespace eti::imaging {

/// A surface as STL (text or binary), Wavefront OBJ or PLY (text or binary) holds it, in millimetres; corners
/// at the same place become one vertex, polygons become triangles. LPS, unless a comment says SPACE=RAS, as
/// 3D Slicer writes it. Throws VolumeError naming file, finding, expectation and remedy. `name` is only
/// named in errors; its ending tells the format.
[[nodiscard]] TriangleMesh parse_mesh(std::span<const std::uint8_t> data, const std::string& name);

/// parse_mesh() of a file in a child process with bounded time and memory. [m], LPS.
[[nodiscard]] TriangleMesh read_mesh(const std::filesystem::path& path, const GuardLimits& limits = {});

}  // namespace eti::imaging
