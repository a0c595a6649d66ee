// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/mesh/patient_outlines.hpp"

#include <optional>

#include "common/model/tools/blade_clearance_deformer.hpp"

namespace eti::render {
namespace {

// Drawn positions [m] of skinned points, without lip retraction.
class Placing {
  public:
    explicit Placing(const view::SceneView& scene) {
        if (scene.laryngoscope_pose() && scene.keys()) {
            blade_ = blade_clearance_for(scene.keys()->laryngoscope(), *scene.laryngoscope_pose(),
                                         scene.landmarks());
            to_blade_ = blade_->tool.inverse();
            box_ = blade_->give_way.where();
        }
    }
    [[nodiscard]] Vec3f operator()(const Vec3f& point) const {
        if (blade_) {
            const Vec3f before = to_blade_ * point;
            if (box_.contains(before)) {
                return blade_->tool * blade_->give_way(before);
            }
        }
        return point;
    }

  private:
    std::optional<PosedBladeClearanceDeformer> blade_;
    RigidTransform to_blade_;
    Eigen::AlignedBox3f box_;
};

}  // namespace

void PatientOutlines::choose(const PatientMesh& patient, const view::SceneView& scene,
                             const PatientMesh::CullView& look) {
    if (build_ != patient.build_revision()) {
        build_ = patient.build_revision();
        parts_.clear();
        for (const PatientMesh::Part& part : patient.parts()) {
            parts_.push_back({.finer = OutlineTessellation(part.blocks.triangles(), part.vertex_count),
                              .placed = std::vector<Placed>(part.vertex_count)});
        }
    }
    const Placing placing(scene);
    const std::uint64_t skinned = patient.skinned_revision();
    const OutlineView outline{look.view_projection, look.eye};
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const PatientMesh::Part& part = patient.parts()[i];
        const bus::RestSurface& model = *scene.rest_surface(part.name);
        const std::vector<TriangleBlocks::Range> near = part.blocks.visible(
            look.view_projection, look.eye, look.plane, PatientMesh::displacement_bound(look),
            [&](const Vec3f& centre, float radius, float longest_edge) {
                return OutlineTessellation::may_be_long(longest_edge, (centre - look.eye).norm() - radius,
                                                        outline);
            });
        parts_[i].finer.choose(near, outline, [&, &placed = parts_[i].placed](std::uint32_t v) {
            if (placed[v].skinned != skinned) {
                placed[v] = {placing(skin_point(model.mesh.vertices[v], model.skin[v], scene.frame_maps())),
                             skinned};
            }
            return look.lips != nullptr ? look.lips->retract_lips(placed[v].place) : placed[v].place;
        });
    }
}

void PatientOutlines::clear() {
    for (Part& part : parts_) {
        part.finer.clear();
    }
}

}  // namespace eti::render
