// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "client/render/finer_faces.hpp"
#include "client/render/patient_mesh.hpp"
#include "client/view/scene_view.hpp"

namespace eti::render {

/// What of a patient is drawn finer in a view.
class PatientOutlines {
  public:
    /// For a mesh that was brought up to date with the scene.
    void choose(const PatientMesh& patient, const view::SceneView& scene, const PatientMesh::Look& look);
    /// Nothing.
    void clear();

    /// Of one of the mesh's parts; nullptr before any was chosen.
    [[nodiscard]] const FinerFaces* of(std::size_t part) const {
        return part < parts_.size() ? &parts_[part].finer : nullptr;
    }

  private:
    // Where skinning and the blade put a vertex, kept for the other views of the same state.
    struct Placed {
        Vec3f place = Vec3f::Zero();  // [m]
        std::uint64_t skinned = 0;
    };
    struct Part {
        FinerFaces finer;
        std::vector<Placed> placed;
    };

    std::uint64_t build_ = 0;
    std::vector<Part> parts_;
};

}  // namespace eti::render
