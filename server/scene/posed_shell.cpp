// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/posed_shell.hpp"

#include <cmath>
#include <mutex>
#include <optional>
#include <span>
#include <utility>

#include "common/mesh/distance.hpp"

namespace eti::scene {

namespace {

DistanceGrid distance_of(const TriangleMesh& mesh, float spacing) {
    Vec3f low = mesh.vertices.front();
    Vec3f high = low;
    for (const Vec3f& v : mesh.vertices) {
        low = low.cwiseMin(v);
        high = high.cwiseMax(v);
    }
    low.array() -= 2.0f * spacing;
    high.array() += 2.0f * spacing;
    return mesh_distance(mesh, low, spacing, grid_nodes(low, high, spacing), PosedShell::band);
}

/// As distance_of(), which takes most of a scene's construction. Keeps the last grid of the process (about 5
/// MB): the next scene is often in the same posture, as when a scenario is repeated. Any thread may call it.
DistanceGrid kept_distance_of(const TriangleMesh& mesh, float spacing) {
    static std::mutex mutex;
    static TriangleMesh last_mesh;
    static DistanceGrid last;
    const std::scoped_lock lock(mutex);
    if (last.spacing != spacing || last_mesh.vertices != mesh.vertices ||
        last_mesh.triangles != mesh.triangles) {
        last = distance_of(mesh, spacing);
        last_mesh = mesh;
    }
    return last;
}

}  // namespace

PosedShell::PosedShell(const patient::Patient& patient, const YieldingSkeleton* skeleton)
    : patient_(patient), skeleton_(skeleton) {
    if (skeleton != nullptr) {
        const auto& rest = patient.shell.mesh.vertices;
        for (std::size_t i = 0; i < rest.size(); ++i) {
            carriers_.push_back({patient.shell.vertex_bones[i], skeleton->hyoid_share(rest[i])});
        }
    }
}

PosedShell::PosedShell(const patient::Patient& patient, const patient::BonePoses& bones,
                       const YieldingSkeleton* skeleton)
    : PosedShell(patient, skeleton) {
    pose_now(bones);
}

void PosedShell::move(const patient::BonePoses& bones) {
    vertices_.resize(patient_.shell.mesh.vertices.size());
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
        const Vec3f& rest = patient_.shell.mesh.vertices[i];
        vertices_[i] = skeleton_ != nullptr
                           ? skeleton_->pose_point(rest, carriers_[i])
                           : patient::pose_point(rest, patient_.shell.vertex_bones[i], bones);
    }
}

void PosedShell::pose(const patient::BonePoses& bones) {
    move(bones);
    update_walls();
    stale_ = true;
    if (!pending_.valid()) {
        start();
    }
}

void PosedShell::start() {
    pending_ = std::async(std::launch::async,
                          [mesh = TriangleMesh{vertices_, patient_.shell.mesh.triangles},
                           spacing = patient_.shell.distance.spacing, carriers = std::span(carriers_),
                           skeleton = skeleton_ == nullptr ? std::nullopt : std::optional(*skeleton_)] {
                              Posed posed{distance_of(mesh, spacing), {}};
                              if (skeleton) {
                                  posed.motion = WallMotion(mesh.vertices, carriers, *skeleton);
                              }
                              return posed;
                          });
    wait_ = grid_delay;
    stale_ = false;
}

void PosedShell::take() {
    Posed posed = pending_.get();
    distance_ = std::move(posed.distance);
    motion_ = std::move(posed.motion);
    ++revision_;
}

void PosedShell::update_walls() {
    if (skeleton_ != nullptr) {
        motion_.update(*skeleton_);
    }
}

void PosedShell::yield() {
    move(skeleton_->bones());
    update_walls();
}

YieldingSkeleton::Carrier PosedShell::carrier_of(std::uint32_t triangle) const {
    YieldingSkeleton::Carrier mean;
    for (const std::uint32_t v : patient_.shell.mesh.triangles[triangle]) {
        for (std::size_t b = 0; b < patient::bone_count; ++b) {
            mean.bones[b] += carriers_[v].bones[b] / 3.0f;
        }
        mean.hyoid += carriers_[v].hyoid / 3.0f;
    }
    return mean;
}

void PosedShell::pose_now(const patient::BonePoses& bones) {
    const bool grid_is_of_mesh = revision_ != 0 && !pending_.valid();
    const std::vector<Vec3f> before = vertices_;
    move(bones);
    if (grid_is_of_mesh && vertices_ == before) {  // as after a reset: nothing to compute
        update_walls();
        ++revision_;
        return;
    }
    if (pending_.valid()) {
        pending_.get();
    }
    distance_ = kept_distance_of({vertices_, patient_.shell.mesh.triangles}, patient_.shell.distance.spacing);
    if (skeleton_ != nullptr) {
        motion_ = WallMotion(vertices_, carriers_, *skeleton_);
    }
    stale_ = false;
    ++revision_;
}

void PosedShell::advance() {
    if (!pending_.valid() || --wait_ > 0) {
        return;
    }
    take();
    update_walls();
    if (stale_) {
        if (skeleton_ != nullptr) {
            move(skeleton_->bones());  // the grid's and the walls' reference
        }
        start();
    }
}

}  // namespace eti::scene
