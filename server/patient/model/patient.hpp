// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/mesh/distance_grid.hpp"
#include "common/mesh/skinning.hpp"
#include "common/mesh/triangle_mesh.hpp"
#include "common/model/landmark.hpp"
#include "common/model/surface.hpp"
#include "common/model/tissue.hpp"

namespace eti::patient {

/// Rigid bodies of the skeleton. They are the model's first frames, in this order; clusters follow.
enum class Bone : std::uint8_t { trunk, skull, mandible };
inline constexpr std::size_t bone_count = 3;

/// The model's last frames, after the clusters. They move with the skull and let the cranium grow: to the
/// left, right, back, front and up. Their rest centres, as vectors from the origin, are the displacement per
/// unit of growth over the built size. A vertex is skinned to the skull and to these.
inline constexpr std::size_t head_frame_count = 5;

/// The skeleton's two joints, in the patient frame of the rest posture.
struct Skeleton {
    Vec3f neck_joint = Vec3f::Zero();   ///< [m]; centre of the skull's rotation about the left-right axis
    Vec3f jaw_joint = Vec3f::Zero();    ///< [m]; midpoint of the temporomandibular joints
    float jaw_slide_per_radian = 0.0f;  ///< [m/rad], forward translation of the condyles
};

/// Posture relative to the rest posture [rad]; head elevation 0-30 deg, jaw opening 0-35 deg, table -20-20
/// deg.
struct Posture {
    float head_elevation = 0.0f;
    float jaw_opening = 0.0f;
    /// Tilt of the table about the patient's left-right axis, positive head-up (reverse Trendelenburg). The
    /// patient frame tilts with the table: only gravity changes in it.
    float table_angle = 0.0f;
    [[nodiscard]] bool operator==(const Posture&) const = default;
};

/// Blend weights over the bones; they sum to one.
using BoneWeights = std::array<float, bone_count>;

/// [kg/m^3], of particles solved in substeps: four times that of tissue. Hands move tissue so slowly that
/// inertia does not matter, but contact forces are correct only if the substep resolves sqrt(mass /
/// stiffness) (docs/decisions/soft-tissue.md).
inline constexpr float tissue_density = 4000.0f;
/// [kg/m^3], physical density of tissue: for gravity, and for all mass of an implicit tongue.
inline constexpr float physical_tissue_density = 1000.0f;
/// [1/s], decay rate of particle velocity. The slowest wave of a term newborn's tongue then decays with 36
/// ms, about as in models of speech (Stavness et al. 2011, Int J Numer Meth Biomed Eng 27:367; see
/// docs/decisions/soft-tissue.md).
inline constexpr float tissue_damping = 200.0f;

/// Particles of the soft tissue, as a structure of arrays of equal length [particles].
struct ParticleSet {
    std::vector<Vec3f> rest;    ///< [m], rest posture
    std::vector<float> mass;    ///< [kg]; 0 marks a particle that moves with bone
    std::vector<float> radius;  ///< [m]
    std::vector<Tissue> tissue;
    std::vector<BoneWeights> bones;  ///< skins the rest shape to other postures
    [[nodiscard]] std::size_t size() const { return rest.size(); }
};

/// Shape-matching clusters: members of cluster c are member[first[c]] .. member[first[c + 1] - 1].
struct ClusterSet {
    std::vector<std::uint32_t> first;   ///< count + 1 entries
    std::vector<std::uint32_t> member;  ///< particle indices
    std::vector<float> youngs_modulus;  ///< [Pa], one per cluster
    std::vector<Tissue> tissue;
    [[nodiscard]] std::size_t size() const { return first.empty() ? 0 : first.size() - 1; }
    [[nodiscard]] std::span<const std::uint32_t> members(std::size_t cluster) const {
        return {member.data() + first[cluster], member.data() + first[cluster + 1]};
    }
};

/// The same tissue as tetrahedra with particles at their corners: the second discretisation.
struct TetrahedronSet {
    std::vector<std::array<std::uint32_t, 4>> corners;  ///< particle indices, in any orientation
    std::vector<float> youngs_modulus;                  ///< [Pa], one per tetrahedron
};

/// Pairs of particles held at their rest distance: tongue to floor of the mouth, hyoepiglottic ligament.
struct LinkSet {
    std::vector<std::array<std::uint32_t, 2>> ends;  ///< particle indices
    std::vector<float> stiffness;                    ///< [N/m]
};

/// The inward offset shell, the collision surface for the laryngoscope's proxy, the tube and the tongue.
struct Shell {
    TriangleMesh mesh;  ///< rest posture
    std::vector<Tissue> triangle_tissue;
    std::vector<BoneWeights> vertex_bones;
    DistanceGrid distance;  ///< rest posture; negative inside the tissue
};

/// A point skinned to frames.
struct CarriedPoint {
    Vec3f rest = Vec3f::Zero();
    SkinWeights skin;
};

/// Everything that the server needs of a patient, in the rest posture, patient frame.
struct Patient {
    Skeleton skeleton;
    ParticleSet particles;
    ClusterSet clusters;
    TetrahedronSet tetrahedra;
    LinkSet links;
    std::vector<Vec3f> frame_rest_centre;  ///< [m]; [bones | clusters | skull]
    std::vector<Surface> surfaces;         ///< body, tongue, epiglottis, bones
    Shell shell;
    std::array<CarriedPoint, landmark_count> landmarks;
    std::vector<CarriedPoint> glottis_contour;  ///< closed polygon around the glottic opening
    float weight = 3.5f;                        ///< [kg]
    float tissue_stiffness = 8e3f;              ///< [Pa], Young's modulus of tongue and mucosa
};

/// Position of a landmark in the rest posture [m].
[[nodiscard]] inline const Vec3f& rest_of(const Patient& patient, Landmark which) {
    return patient.landmarks[static_cast<std::size_t>(which)].rest;
}

}  // namespace eti::patient
