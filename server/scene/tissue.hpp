// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <vector>

#include "server/anatomy/patient.hpp"
#include "server/anatomy/skeleton.hpp"
#include "server/pbd/soft_body.hpp"

namespace eti::scene {

/// The patient's soft tissue in the particle solver: set up from the model, posed with the skeleton,
/// and read back as frames for skinning.
class SoftTissue {
  public:
    explicit SoftTissue(const anatomy::Patient& patient);

    /// Carries the unloaded shape to a posture. Particles bound to bone go there over the next step.
    void pose(const anatomy::BonePoses& bones);

    /// Poses of bones and clusters relative to the model's rest posture. Resizes `frames` once.
    void frames(std::vector<FramePose>& frames) const;

    [[nodiscard]] pbd::SoftBody& body() { return body_; }
    [[nodiscard]] const pbd::SoftBody& body() const { return body_; }
    [[nodiscard]] Tissue tissue_of(std::size_t particle) const {
        return static_cast<Tissue>(body_.particles.object[particle]);
    }
    void reset();

  private:
    const anatomy::Patient& patient_;
    pbd::SoftBody body_;
    anatomy::BonePoses bones_;
    std::vector<anatomy::BoneWeights> cluster_bones_;  // mean over a cluster's members
    std::vector<Quatf> cluster_turn_;                  // model rest to posed rest
    std::vector<Vec3f> cluster_posed_centre_;          // frame centre carried to the posed rest
};

}  // namespace eti::scene
