// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "client/render/mesh/outline_tessellation.hpp"
#include "client/render/mesh/patient_mesh.hpp"
#include "client/view/scene_view.hpp"

namespace eti::render {

/// The triangles of a patient that are tessellated in a view.
class PatientOutlines {
  public:
    /// The mesh must be up to date with the scene.
    void choose(const PatientMesh& patient, const view::SceneView& scene, const PatientMesh::CullView& look);
    /// Selects none.
    void clear();

    /// Selection for one of the mesh's parts; nullptr before the first choose().
    [[nodiscard]] const OutlineTessellation* of(std::size_t part) const {
        return part < parts_.size() ? &parts_[part].finer : nullptr;
    }

  private:
    // Position of a vertex after skinning and blade displacement, cached for the other views of the same
    // state.
    struct Placed {
        Vec3f place = Vec3f::Zero();  // [m]
        std::uint64_t skinned = 0;
    };
    struct Part {
        OutlineTessellation finer;
        std::vector<Placed> placed;
    };

    std::uint64_t build_ = 0;
    std::vector<Part> parts_;
};

}  // namespace eti::render
