// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "server/patient/model/patient.hpp"
#include "server/patient/model/skeleton.hpp"
#include "server/pbd/soft_body.hpp"
#include "server/scene/drawn_fit.hpp"
#include "server/scene/tongue.hpp"

namespace eti::scene {

/// The patient's soft tissue in the particle solver: set up from the model, posed with the skeleton,
/// and read back as frames for skinning.
class SoftTissue {
  public:
    /// `substep` [s]: what a cluster is given for the stiffness that the patient's tissue shall have
    /// depends on it.
    SoftTissue(const anatomy::Patient& patient, TissueMethod model, float substep);

    /// Carries the unloaded shape to a posture. Particles bound to bone go there over the next step.
    void pose(const anatomy::BonePoses& bones);

    /// How the tongue grows (see anatomy::tongue_swelling()); needed before set_tongue_growth().
    void set_swelling(std::vector<Vec3f> displacement);
    [[nodiscard]] bool knows_swelling() const { return !swelling_.empty(); }
    /// Length of the tongue over that of the built one; takes effect with the next pose(). Masses stay: they
    /// are none of the tissue's own (docs/decisions/soft-tissue.md).
    void set_tongue_growth(float growth);
    /// Young's modulus of tongue and mucosa [Pa]; in shape and state nothing changes.
    void set_stiffness(float soft);

    /// From now on tissue at rest sleeps, where begin_step() and end_step() of the body enclose a step.
    void let_sleep();

    /// Poses of bones and clusters relative to the model's rest posture. Resizes `frames` once. Clusters
    /// that tetrahedra stand in for are fitted to the particles here, and to the drawn surface. Those that
    /// sleep are left in `frames` as the last call put them, which is to be from before they fell asleep.
    /// `head_size` is the cranium's over that of the built one.
    void frames(std::vector<FramePose>& frames, float head_size = 1.0f);

    /// Edges of the mesh's surface whose ends both move: pairs of particles.
    [[nodiscard]] const std::vector<std::array<std::uint32_t, 2>>& surface_edges() const {
        return surface_edges_;
    }

    /// The tongue, where it is of tetrahedra; else empty.
    [[nodiscard]] Tongue& tongue() { return tongue_; }
    [[nodiscard]] const Tongue& tongue() const { return tongue_; }
    [[nodiscard]] pbd::SoftBody& body() { return body_; }
    [[nodiscard]] const pbd::SoftBody& body() const { return body_; }
    [[nodiscard]] Tissue tissue_of(std::size_t particle) const {
        return static_cast<Tissue>(body_.particles.object[particle]);
    }
    void reset();

  private:
    /// The patient's clusters that `wanted` names, as the solver takes them; of their members those within
    /// so many spacings of the middle.
    [[nodiscard]] pbd::ShapeMatching::Description description(
        std::span<const std::uint32_t> wanted, float substep,
        float reach = std::numeric_limits<float>::infinity()) const;
    /// The particle at rest in the model's posture, as far as the tongue has grown.
    [[nodiscard]] Vec3f grown(std::size_t particle) const;
    void update_moduli();
    /// Of the clusters from `first` to before `end`.
    void frames_of(const pbd::ShapeMatching& shapes, std::span<const std::uint32_t> clusters,
                   std::size_t first, std::size_t end, std::vector<FramePose>& frames) const;

    const anatomy::Patient& patient_;
    pbd::SoftBody body_;
    std::vector<std::array<std::uint32_t, 2>> surface_edges_;
    Tongue tongue_;
    pbd::ShapeMatching fitted_;  // to particles that tetrahedra move: only for their frames
    DrawnFit drawn_;             // what is fitted, to the tetrahedra
    std::vector<std::uint32_t> held_clusters_, fitted_clusters_;  // the patient's numbers of both
    anatomy::BonePoses bones_;
    std::vector<anatomy::BoneWeights> cluster_bones_;  // mean over a cluster's members
    std::vector<Quatf> cluster_turn_;                  // model rest to posed rest
    std::vector<Vec3f> cluster_posed_centre_;          // frame centre carried to the posed rest
    float substep_;                                    // [s]
    float soft_;                                       // [Pa], modulus of tongue and mucosa
    float growth_ = 1.0f;                              // of the tongue
    std::vector<Vec3f> swelling_, cluster_swelling_;   // [m] per unit of growth; of clusters the mean
    std::vector<std::uint32_t> meshed_;                // the patient's numbers of the tetrahedra in use
    std::vector<float> moduli_;                        // scratch
};

}  // namespace eti::scene
