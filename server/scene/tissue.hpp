// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "server/patient/model/cells_of.hpp"
#include "server/patient/model/patient.hpp"
#include "server/patient/model/skeleton.hpp"
#include "server/pbd/soft/soft_body.hpp"
#include "server/scene/skin_frame_correction.hpp"
#include "server/scene/tongue/tongue.hpp"

namespace eti::scene {

/// The patient's soft tissue in the particle solver: built from the model, posed with the skeleton, read back
/// as frames for skinning. Not thread safe: the physics thread calls all functions.
class SoftTissue {
  public:
    /// `substep` [s]: the calibrated stiffness of clusters depends on it.
    SoftTissue(const patient::Patient& patient, TissueMethod method, float substep);

    /// Carries the unloaded shape to a posture. Particles bound to bone move there over the next step.
    void pose(const patient::BonePoses& bones);

    /// Poses of the bones themselves, where they yield from that of the unloaded shape.
    void set_bones(const patient::BonePoses& bones) { bones_ = bones; }
    /// Rest position [m] of a particle in the model's posture, with the tongue's current growth.
    [[nodiscard]] Vec3f unposed(std::size_t particle) const { return grown(particle); }

    /// Sets the tongue's growth field [particles][m] (see patient::tongue_swelling()); required before
    /// set_tongue_growth().
    void set_swelling(std::vector<Vec3f> displacement);
    [[nodiscard]] bool has_swelling() const { return !swelling_.empty(); }
    /// Length of the tongue relative to the built one; takes effect with the next pose(). Masses do not
    /// change: they are numerical, not the tissue's (docs/decisions/soft-tissue.md).
    void set_tongue_growth(float growth);
    /// Young's modulus of tongue and mucosa [Pa]; shape and state do not change.
    void set_stiffness(float soft);

    /// From now on the stress of the implicit mesh relaxes.
    void relax(const pbd::Relaxation& relaxation) { tongue_.relax(relaxation); }
    /// Lets tissue at rest sleep from now on; the body's begin_step() and end_step() must then enclose each
    /// step.
    void enable_sleeping();

    /// Poses [bones | clusters | skull] relative to the model's rest posture. Resizes `frames` once. Clusters
    /// replaced by tetrahedra are fitted here to the particles and to the drawn surface. Entries of sleeping
    /// clusters keep their values, which must be from before they fell asleep. `head_size`: the cranium's
    /// size relative to the built one.
    void frames(std::vector<FramePose>& frames, float head_size = 1.0f);

    /// Surface edges of the mesh whose ends both move: pairs of particles.
    [[nodiscard]] const std::vector<std::array<std::uint32_t, 2>>& surface_edges() const {
        return surface_edges_;
    }

    /// The implicit mesh of tongue and epiglottis. Empty with clusters throughout.
    [[nodiscard]] Tongue& tongue() { return tongue_; }
    [[nodiscard]] const Tongue& tongue() const { return tongue_; }
    [[nodiscard]] pbd::SoftBody& body() { return body_; }
    [[nodiscard]] const pbd::SoftBody& body() const { return body_; }
    [[nodiscard]] Tissue tissue_of(std::size_t particle) const {
        return static_cast<Tissue>(body_.particles.object[particle]);
    }
    void reset();

  private:
    /// Solver description of the patient's clusters in `wanted`; of their members, those within `reach`
    /// spacings of the centre.
    [[nodiscard]] pbd::ShapeMatching::Description description(
        std::span<const std::uint32_t> wanted, float substep,
        float reach = std::numeric_limits<float>::infinity()) const;
    /// Rest position of a particle in the model's posture, with the tongue's current growth.
    [[nodiscard]] Vec3f grown(std::size_t particle) const;
    void update_moduli();
    /// The mesh's surface that the blade meets. `meshed` [particles]: corner of an element.
    [[nodiscard]] TongueContacts::Surface surface_of_mesh(const std::vector<bool>& meshed) const;
    /// What the mesh must not overlap: the tongue, of itself and of the epiglottis.
    [[nodiscard]] SelfContactFinder::Description solid() const;
    /// Of the mesh's elements.
    void fill_moduli(float soft);
    /// For clusters in [first, end).
    void frames_of(const pbd::ShapeMatching& shapes, std::span<const std::uint32_t> clusters,
                   std::size_t first, std::size_t end, std::vector<FramePose>& frames) const;

    const patient::Patient& patient_;
    pbd::SoftBody body_;
    std::vector<std::array<std::uint32_t, 2>> surface_edges_;  // [edges]: particle indices
    Tongue tongue_;
    pbd::ShapeMatching fitted_;  // clusters of particles that tetrahedra move; used for their frames only
    SkinFrameCorrection drawn_;  // corrects fitted frames to the tetrahedra
    std::vector<std::uint32_t> held_clusters_, fitted_clusters_;  // indices of both in the patient
    /// Links that the mesh solves, and those that substeps do: indices in the patient.
    std::vector<std::uint32_t> mesh_links_, substep_links_;
    patient::BonePoses bones_;
    std::vector<patient::BoneWeights> cluster_bones_;  // [clusters], mean over the members
    std::vector<Quatf> cluster_turn_;                  // [clusters], rotation from model rest to posed rest
    std::vector<Vec3f> cluster_posed_centre_;          // [clusters][m], frame centre in the posed rest
    float substep_;                                    // [s]
    float soft_;                                       // [Pa], Young's modulus of tongue and mucosa
    float growth_ = 1.0f;                              // growth of the tongue
    std::vector<Vec3f> swelling_;          // [particles][m] per unit of growth; empty until it is set
    std::vector<Vec3f> cluster_swelling_;  // [clusters][m], mean over the members
    std::vector<std::uint32_t> meshed_;    // indices, in the patient, of the tetrahedra in use
    patient::Cells cells_;                 // the same, with whole cells joined
    std::vector<float> tetrahedron_moduli_, hexahedron_moduli_;  // [cells_][Pa]
    std::vector<float> moduli_;                                  // scratch
};

}  // namespace eti::scene
