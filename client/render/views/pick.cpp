// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/views/pick.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "client/view/sight/ray.hpp"
#include "common/model/tools/blade_clearance_deformer.hpp"
#include "common/model/tools/lip_retraction.hpp"

namespace eti::render {
namespace {

using view::Ray;

/// Corners of a surface as drawn in a view. The undisplaced corners give a cheap test of whether a triangle
/// can matter.
class Corners {
  public:
    Corners(const view::SkinnedSurface& surface, const std::optional<PosedBladeClearanceDeformer>& blade,
            const LipRetraction* lips)
        : mesh_(surface.model().mesh),
          skinned_(surface.vertices()),
          blade_(is_bone(surface.model().tissue) ? std::nullopt : blade),
          lips_(lips),
          most_((blade_ ? blade_->give_way.reach() : 0.0f) + (lips_ != nullptr ? lips_->reach() : 0.0f)) {}

    [[nodiscard]] std::span<const Triangle> triangles() const { return mesh_.triangles; }
    /// Without lip retraction.
    [[nodiscard]] Vec3f still(std::uint32_t v) const {
        return blade_ ? (*blade_)(skinned_[v].position) : skinned_[v].position;
    }
    [[nodiscard]] Vec3f drawn(std::uint32_t v) const {
        return lips_ != nullptr ? lips_->retract_lips(still(v)) : still(v);
    }
    /// [m] maximum distance of any point of the triangle from its first corner.
    [[nodiscard]] float reach(const Triangle& t) const {
        const Vec3f& a = skinned_[t[0]].position;
        return most_ +
               std::sqrt(std::max((skinned_[t[1]].position - a).squaredNorm(),
                                  (skinned_[t[2]].position - a).squaredNorm())) +
               most_;
    }
    [[nodiscard]] const Vec3f& near(const Triangle& t) const { return skinned_[t[0]].position; }

  private:
    const TriangleMesh& mesh_;
    std::span<const view::LitVertex> skinned_;
    std::optional<PosedBladeClearanceDeformer> blade_;
    const LipRetraction* lips_;
    float most_;
};

struct PickRay {
    Vec3f from, to;
    bool on_cut = false;  ///< starts on a section face
};

/// From the camera to the far plane; in a section, from the section face on.
std::optional<PickRay> pick_ray(const View& view, const view::SceneView& scene, const Vantage& from,
                                float aspect, float x, float y) {
    const std::vector<Camera> cameras = view.cameras(scene, from);
    const auto count = static_cast<float>(cameras.size());
    const float across = 0.5f * (x + 1.0f) * count;
    const auto i = std::min(static_cast<std::size_t>(std::max(across, 0.0f)), cameras.size() - 1);
    const float within = 2.0f * (across - static_cast<float>(i)) - 1.0f;
    const Camera& camera = cameras[i];
    const Eigen::Matrix4f inverse = (camera.projection(aspect / count) * camera.view()).inverse();
    const auto point = [&](float depth) -> Vec3f {
        return (inverse * Eigen::Vector4f(within, y, depth, 1.0f)).hnormalized();
    };
    PickRay sight{point(-1.0f), point(1.0f)};
    if (!view.cut) {
        return sight;
    }
    const Eigen::Vector4f kept = from.section.plane(scene.landmarks()).kept();
    const float begins = kept.dot(sight.from.homogeneous()), ends = kept.dot(sight.to.homogeneous());
    if (begins < 0.0f) {
        if (ends <= 0.0f) {
            return std::nullopt;
        }
        sight.from += begins / (begins - ends) * (sight.to - sight.from);
        sight.on_cut = true;
    }
    return sight;
}

/// Triangles that a ray may hit.
template <class Use>
void along(const PickRay& sight, const Corners& corners, const Use& use) {
    const Vec3f way = (sight.to - sight.from).normalized();
    const auto triangles = corners.triangles();
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        const Vec3f aside = corners.near(triangles[t]) - sight.from;
        const float reach = corners.reach(triangles[t]);
        if (aside.squaredNorm() - aside.dot(way) * aside.dot(way) <= reach * reach) {
            use(t, triangles[t]);
        }
    }
}

/// The nearest triangle above or below a point.
std::optional<SurfacePlace> place_near(const Vec3f& point, const Corners& corners) {
    std::optional<SurfacePlace> best;
    const auto triangles = corners.triangles();
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        if (best && (corners.near(triangles[t]) - point).norm() - corners.reach(triangles[t]) >
                        std::abs(best->height)) {
            continue;
        }
        const Vec3f a = corners.drawn(triangles[t][0]);
        const Vec3f ab = corners.drawn(triangles[t][1]) - a, ac = corners.drawn(triangles[t][2]) - a;
        const Vec3f ap = point - a, normal = ab.cross(ac);
        const float square = normal.squaredNorm();
        if (square == 0.0f) {
            continue;
        }
        const SurfacePlace place{t, ap.cross(ac).dot(normal) / square, ab.cross(ap).dot(normal) / square,
                                 ap.dot(normal) / std::sqrt(square)};
        if (place.is_valid() && (!best || std::abs(place.height) < std::abs(best->height))) {
            best = place;
        }
    }
    return best;
}

bool contains(const Corners& corners, const PickRay& sight) {
    int crossed = 0;
    along(sight, corners, [&](std::uint32_t, const Triangle& t) {
        crossed += Ray(sight.from, sight.to)
                           .intersects(corners.drawn(t[0]), corners.drawn(t[1]), corners.drawn(t[2]))
                       ? 1
                       : 0;
    });
    return crossed % 2 == 1;
}

/// Drawing order on a section face: bones over organs, organs over the surrounding body.
int layer(Tissue tissue) {
    return is_bone(tissue) ? 2 : tissue == Tissue::soft ? 0 : 1;
}

}  // namespace

std::optional<PickHit> pick(const View& view, const view::SceneView& scene, const Vantage& from, float aspect,
                            float x, float y) {
    const auto sight = pick_ray(view, scene, from, aspect, x, y);
    if (!sight) {
        return std::nullopt;
    }
    const LipRetraction lips = lip_retraction(from.eye.position(scene.landmarks()), scene.landmarks());
    std::optional<PosedBladeClearanceDeformer> blade;
    if (scene.laryngoscope_pose() && scene.keys()) {
        blade =
            blade_clearance_for(scene.keys()->laryngoscope(), *scene.laryngoscope_pose(), scene.landmarks());
    }
    Ray ray(sight->from, sight->to);
    std::optional<PickHit> met, on_face;
    int on_top = -1;
    for (const auto& [name, surface] : scene.surfaces()) {
        const bus::RestSurface& model = surface.model();
        if (is_bone(model.tissue) && !sight->on_cut) {  // inside the body, always hidden
            continue;
        }
        const Corners corners(surface, blade, view.lips_retracted ? &lips : nullptr);
        if (sight->on_cut && layer(model.tissue) > on_top && contains(corners, *sight)) {
            if (const auto place = place_near(sight->from, corners)) {
                on_top = layer(model.tissue);
                on_face = PickHit{sight->from, name_of(model.triangle_tissue[place->triangle]), name, *place};
            }
        }
        if (is_bone(model.tissue)) {
            continue;
        }
        along(*sight, corners, [&](std::uint32_t t, const Triangle& triangle) {
            const auto& [a, b, c] = triangle;
            if (ray.intersects(corners.drawn(a), corners.drawn(b), corners.drawn(c), true)) {
                const SurfacePlace place{t, ray.u(), ray.v(), 0.0f};
                met = PickHit{point_at(place, corners.still(a), corners.still(b), corners.still(c)),
                              name_of(model.triangle_tissue[t]), name, place};
            }
        });
    }
    if (on_face) {
        return on_face;
    }
    if (const view::TubeSweep* const tube = scene.tube()) {
        const auto vertices = tube->vertices();
        for (const auto& [a, b, c] : tube->triangles()) {
            if (ray.intersects(vertices[a].position, vertices[b].position, vertices[c].position, true)) {
                met = PickHit{ray.end(), "tube"};
            }
        }
    }
    if (scene.laryngoscope() && scene.laryngoscope_pose()) {
        const RigidTransform& pose = *scene.laryngoscope_pose();
        const TriangleMesh& mesh = *scene.laryngoscope();
        Ray held(pose.inverse() * sight->from, pose.inverse() * ray.end());
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            const auto& [a, b, c] = mesh.triangles[t];
            if (held.intersects(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], true)) {
                met = PickHit{
                    pose * held.end(), "blade", bus::laryngoscope_object, {t, held.u(), held.v(), 0.0f}};
            }
        }
    }
    return met;
}

}  // namespace eti::render
