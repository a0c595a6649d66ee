// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/posed_shell.hpp"

#include <cmath>
#include <mutex>

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
    std::array<int, 3> size{};
    for (int k = 0; k < 3; ++k) {
        size[static_cast<std::size_t>(k)] = static_cast<int>(std::ceil((high[k] - low[k]) / spacing)) + 1;
    }
    return mesh_distance(mesh, low, spacing, size, PosedShell::band);
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

PosedShell::PosedShell(const patient::Patient& patient, const patient::BonePoses& bones) : patient_(patient) {
    pose_now(bones);
}

void PosedShell::move(const patient::BonePoses& bones) {
    vertices_.resize(patient_.shell.mesh.vertices.size());
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
        vertices_[i] =
            patient::pose_point(patient_.shell.mesh.vertices[i], patient_.shell.vertex_bones[i], bones);
    }
}

void PosedShell::pose(const patient::BonePoses& bones) {
    move(bones);
    stale_ = true;
    if (!pending_.valid()) {
        start();
    }
}

void PosedShell::start() {
    pending_ = std::async(std::launch::async,
                          [mesh = TriangleMesh{vertices_, patient_.shell.mesh.triangles},
                           spacing = patient_.shell.distance.spacing] { return distance_of(mesh, spacing); });
    wait_ = grid_delay;
    stale_ = false;
}

void PosedShell::take() {
    distance_ = pending_.get();
    ++revision_;
}

void PosedShell::pose_now(const patient::BonePoses& bones) {
    const bool grid_is_of_mesh = revision_ != 0 && !pending_.valid();
    const std::vector<Vec3f> before = vertices_;
    move(bones);
    if (grid_is_of_mesh && vertices_ == before) {  // as after a reset: nothing to compute
        ++revision_;
        return;
    }
    if (pending_.valid()) {
        pending_.get();
    }
    distance_ = kept_distance_of({vertices_, patient_.shell.mesh.triangles}, patient_.shell.distance.spacing);
    stale_ = false;
    ++revision_;
}

void PosedShell::advance() {
    if (!pending_.valid() || --wait_ > 0) {
        return;
    }
    take();
    if (stale_) {
        start();
    }
}

}  // namespace eti::scene
