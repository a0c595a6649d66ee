// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/math/units.hpp"
#include "common/mesh/distance.hpp"
#include "common/mesh/isosurface.hpp"
#include "common/mesh/simplify.hpp"
#include "server/parallel/loops.hpp"
#include "server/patient/mesh/smooth.hpp"
#include "server/patient/model/stiffness.hpp"
#include "server/patient/newborn/build/build.hpp"
#include "server/patient/newborn/build/sample.hpp"
#include "server/patient/newborn/newborn.hpp"

namespace eti::patient {

namespace {

// Removes the slivers of marching tetrahedra, which would prevent edges from collapsing.
constexpr int shell_smoothing_rounds = 3;

constexpr float shell_band = 4e-3f;  // [m], within which the shell's distances are exact

}  // namespace

void build_shell(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient) {
    const float size = anatomy.scale() / millimetre;
    const auto [low, high] = anatomy.airway_bounds();
    // Includes the face: a blade must not pass through lips and nose.
    const Vec3f room(10e-3f * size, 12e-3f * size, 8e-3f * size);
    DistanceGrid field = grid_over(low - room, high + room, 1.0e-3f * size);
    sample(anatomy, field, [&](std::size_t i, const Fields& f, const Vec3f& point) {
        field.value[i] = anatomy.shell_field(point, f);
    });
    TriangleMesh shell = isosurface(field, 0.0f);
    // Operators are tuned to this shell: a few self-intersections less than a millimetre deep do not justify
    // another.
    smooth(shell, shell_smoothing_rounds);
    patient.shell.mesh = simplify(shell, {.triangles = settings.shell_triangles, .importance = {}});
    patient.shell.distance =
        mesh_distance(patient.shell.mesh, field.origin, field.spacing, field.size, shell_band);
    for (const Triangle& t : patient.shell.mesh.triangles) {
        const auto& v = patient.shell.mesh.vertices;
        patient.shell.triangle_tissue.push_back(anatomy.lining((v[t[0]] + v[t[1]] + v[t[2]]) / 3.0f));
    }
    for (const Vec3f& v : patient.shell.mesh.vertices) {
        patient.shell.vertex_bones.push_back(anatomy.bone_weights(v, anatomy.lining(v)));
    }
}

Patient build_patient(const Anatomy& anatomy, const BuildSettings& settings, const Patient* surface_source) {
    Patient patient;
    patient.weight = anatomy.weight();
    patient.skeleton = anatomy.skeleton();
    const std::vector<LatticePlace> places = build_particles(anatomy, settings, patient);
    build_clusters(anatomy, settings, patient);
    build_tetrahedra(places, patient);
    build_links(anatomy, settings, patient);
    set_tissue_stiffness(patient, settings.tissue_stiffness);
    build_frames(patient);
    if (surface_source != nullptr) {
        patient.surfaces = surface_source->surfaces;
        patient.shell = surface_source->shell;
    } else {
        parallel::run_both([&] { build_surfaces(anatomy, settings, patient); },
                           [&] { build_shell(anatomy, settings, patient); });
    }
    skin_surfaces(anatomy, settings, patient);
    build_landmarks(anatomy, settings, patient);
    return patient;
}

Patient build_patient(const NewbornShape& shape, const BuildSettings& settings,
                      const Patient* surface_source) {
    return build_patient(Newborn(shape), settings, surface_source);
}

}  // namespace eti::patient
