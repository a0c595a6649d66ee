// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/room/room_meshes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/render/room/furniture.hpp"
#include "common/model/tools/parked_pose.hpp"

namespace eti::render {
namespace {

constexpr float unseen_shift = 0.4e-3f;  // [m]
// The mattress stays where it is while the head's back is within this of its level: above it, the headrest is
// thicker; below, thinner. [m]
constexpr float thickest = 25e-3f, thinnest = 6e-3f;
constexpr std::size_t fine_triangles = 6000, coarse_triangles = 900;  // of a hand

GpuMesh mesh_of(const Solid& solid) {
    return {solid.triangles, solid.vertices, solid.colours};
}

// Meshing takes some tenths of a second; the shapes are the same in every scene.
template <Grip grip>
const std::array<Solid, 2>& solids_of() {
    static const std::array<Solid, 2> solids{gloved_hand(grip, fine_triangles),
                                             gloved_hand(grip, coarse_triangles)};
    return solids;
}

const std::array<Solid, 2>& hand_solids(Grip grip) {
    constexpr std::array<const std::array<Solid, 2>& (*)(), grip_count> made_once{
        solids_of<Grip::handle>, solids_of<Grip::tube>, solids_of<Grip::larynx>};
    return made_once[static_cast<std::size_t>(grip)]();
}

bool presses_larynx(const RuntimeParameters& live) {
    constexpr float touch = 0.05f;  // [N]
    const Vec3f force(live.laryngeal_pressure_back, live.laryngeal_pressure_up,
                      live.laryngeal_pressure_right);
    return force.norm() > touch;  // false for NaN, of a server that publishes none
}

bool parked(const RigidTransform& pose, Tool tool) {
    return (pose.translation - parked_pose(tool).translation).norm() < 1e-3f;
}

float lowest(std::span<const Vec3f> points) {
    return std::ranges::max(points, {}, [](const Vec3f& p) { return p.y(); }).y();
}

}  // namespace

void RoomMeshes::build(const view::SceneView& scene, const Solid& blade) {
    outline_.build(scene);
    find_larynx(scene);
    shaped_for_.clear();
    bedding_.reset();
    bedding_mesh_.reset();
    const Furniture room = make_furniture(blade);
    furniture_.clear();
    for (const Solid& part : room.dull) {
        Eigen::AlignedBox3f box;
        for (const view::LitVertex& vertex : part.vertices) {
            box.extend(vertex.position);
        }
        furniture_.push_back(
            {mesh_of(part), box.center(), 0.5f * box.diagonal().norm(), &part != &room.dull.back()});
    }
    glowing_.emplace(mesh_of(room.glowing));
    Solid screen;
    const Vec3f towards_viewer = room.screen_down.cross(room.screen_right).normalized();
    for (const float down : {-1.0f, 1.0f}) {
        for (const float right : {-1.0f, 1.0f}) {
            screen.vertices.push_back(
                {room.screen_centre + right * room.screen_right + down * room.screen_down, towards_viewer});
            // Picture coordinates, from the lower left.
            screen.colours.push_back({static_cast<std::uint8_t>(right > 0.0f ? 255 : 0),
                                      static_cast<std::uint8_t>(down > 0.0f ? 0 : 255), 0, 255});
        }
    }
    screen.triangles = {{0, 2, 1}, {1, 2, 3}};
    screen_.emplace(
        Screen{mesh_of(screen), room.screen_centre, (room.screen_right + room.screen_down).norm()});
}

void RoomMeshes::rest(const view::SceneView& scene) {
    std::vector<Vec3f> points = outline_.points(scene);
    if (points.empty()) {
        return;
    }
    float moved_from = std::numeric_limits<float>::infinity();  // [m], z
    for (std::size_t k = 0; bedding_ && k < points.size(); ++k) {
        if (!((points[k] - shaped_for_[k]).squaredNorm() < unseen_shift * unseen_shift)) {
            moved_from = std::min({moved_from, points[k].z(), shaped_for_[k].z()});
        }
    }
    if (bedding_ && std::isinf(moved_from)) {
        return;
    }
    const BodyProfile body = profile_of(points);
    const float above = bedding_ ? bedding_->rest().mattress - lowest(points) : 0.0f;
    if (!bedding_ || above > thickest || above < -thinnest) {
        bedding_.emplace(rest_of(body), body);
        bedding_mesh_.emplace(*bedding_);
        pose_.translation =
            Vec3f(0.0f, bedding_->rest().mattress, bedding_->rest().head_top_z + mattress_margin);
    } else {
        const int rows = bedding_->follow(body, moved_from);
        bedding_mesh_->update(*bedding_, rows);
    }
    shaped_for_ = std::move(points);
}

void RoomMeshes::hold(const view::SceneView& scene) {
    hands_.clear();
    const auto add = [&](Grip grip, const RigidTransform& pose) {
        auto& mesh = hand_meshes_[static_cast<std::size_t>(grip)];
        if (!mesh) {
            const auto& [fine, coarse] = hand_solids(grip);
            mesh.emplace(HandMeshes{mesh_of(fine), mesh_of(coarse)});
        }
        hands_.push_back({&mesh->fine, &mesh->coarse, pose});
    };
    const auto& blade = scene.laryngoscope_pose();
    if (blade && !parked(*blade, Tool::laryngoscope)) {
        add(Grip::handle, *blade);
    }
    if (const view::TubeSweep* tube = scene.tube()) {
        const auto grip = tube_grip(scene.tube_nodes(), tube->tube().grip_from_tip);
        if (grip && !parked(*grip, Tool::tube)) {
            add(Grip::tube, *grip);
        }
    }
    if (over_larynx_ && presses_larynx(scene.live())) {
        add(Grip::larynx,
            larynx_grip(skin_point(over_larynx_->rest, over_larynx_->skin, scene.frame_maps())));
    }
}

// The foremost skin within a fingertip's reach in front of the larynx.
void RoomMeshes::find_larynx(const view::SceneView& scene) {
    constexpr float beside = 5e-3f;  // [m]
    const Vec3f larynx = at(scene.rest_landmarks(), Landmark::glottis_anterior);
    over_larynx_.reset();
    for (const auto& [name, surface] : scene.surfaces()) {
        const bus::RestSurface& model = surface.model();
        for (std::size_t v = 0; v < model.mesh.vertices.size(); ++v) {
            const Vec3f& p = model.mesh.vertices[v];
            const bool before =
                std::hypot(p.x() - larynx.x(), p.z() - larynx.z()) < beside && p.y() < larynx.y();
            if (before && (!over_larynx_ || p.y() < over_larynx_->rest.y())) {
                over_larynx_ = SkinPoint{p, model.skin[v]};
            }
        }
    }
}

void RoomMeshes::sync(const view::SceneView& scene) {
    rest(scene);
    hold(scene);
    const LiveMeasures& now = scene.measures();
    traces_.update(
        1e-9 * static_cast<double>(scene.simulation_time_ns()),
        std::isfinite(now.heart_rate_per_min) ? std::optional<double>(now.heart_rate_per_min) : std::nullopt);
}

}  // namespace eti::render
