// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/model/patient_hash.hpp"

#include <span>

#include "common/math/hash.hpp"

namespace eti::patient {

namespace {

template <class T>
void add(Hash& hash, const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T> || std::is_same_v<T, Vec3f>);
    hash.add(std::span<const T>(values));
}

/// A value without padding.
template <class T>
void add_bits(Hash& hash, const T& value) {
    hash.bytes(&value, sizeof value);
}

void add(Hash& hash, const CarriedPoint& point) {
    add_bits(hash, point.rest);
    add_bits(hash, point.skin.frame);
    add_bits(hash, point.skin.weight);
}

}  // namespace

std::uint64_t hash_of(const Patient& patient) {
    Hash hash;
    add_bits(hash, patient.skeleton.neck_joint);
    add_bits(hash, patient.skeleton.jaw_joint);
    add_bits(hash, patient.skeleton.jaw_slide_per_radian);
    add(hash, patient.particles.rest);
    add(hash, patient.particles.mass);
    add(hash, patient.particles.radius);
    add(hash, patient.particles.tissue);
    add(hash, patient.particles.bones);
    add(hash, patient.clusters.first);
    add(hash, patient.clusters.member);
    add(hash, patient.clusters.youngs_modulus);
    add(hash, patient.clusters.tissue);
    add(hash, patient.tetrahedra.corners);
    add(hash, patient.tetrahedra.youngs_modulus);
    add(hash, patient.links.ends);
    add(hash, patient.links.stiffness);
    add(hash, patient.frame_rest_centre);
    add(hash, patient.shell.mesh.vertices);
    add(hash, patient.shell.mesh.triangles);
    add(hash, patient.shell.triangle_tissue);
    add(hash, patient.shell.vertex_bones);
    add_bits(hash, patient.shell.distance.origin);
    add_bits(hash, patient.shell.distance.spacing);
    add_bits(hash, patient.shell.distance.size);
    add(hash, patient.shell.distance.value);
    for (const CarriedPoint& point : patient.landmarks) {
        add(hash, point);
    }
    for (const CarriedPoint& point : patient.glottis_contour) {
        add(hash, point);
    }
    add_bits(hash, patient.weight);
    add_bits(hash, patient.tissue_stiffness);
    return hash.value();
}

}  // namespace eti::patient
