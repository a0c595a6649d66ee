// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/patient/model/patient.hpp"

namespace eti::app {

/// A tongue of one triangle on frame 7 of that many, all of which rest at one point.
inline patient::Patient patient_of_a_triangle(std::size_t frames, const Vec3f& rest_centre) {
    patient::Patient patient;
    patient.frame_rest_centre.assign(frames, rest_centre);
    Surface surface;
    surface.name = "tongue";
    surface.tissue = Tissue::tongue;
    surface.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    surface.mesh.triangles = {{0, 1, 2}};
    surface.triangle_tissue = {Tissue::tongue};
    surface.skin.assign(3, {{7, 0, 0, 0}, {1.0f, 0, 0, 0}});
    patient.surfaces.push_back(surface);
    return patient;
}

}  // namespace eti::app
