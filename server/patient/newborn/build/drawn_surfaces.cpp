// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <array>
#include <cmath>
#include <functional>

#include "common/math/units.hpp"
#include "common/mesh/isosurface.hpp"
#include "server/parallel/loops.hpp"
#include "server/patient/mesh/adaptive_isosurface.hpp"
#include "server/patient/mesh/without_self_intersection.hpp"
#include "server/patient/newborn/build/build.hpp"
#include "server/patient/newborn/build/sample.hpp"
#include "server/patient/newborn/build/sizing_field.hpp"

namespace eti::patient {

namespace {

// Removes the slivers of marching tetrahedra, which would prevent edges from collapsing; moves vertices by a
// tenth of an edge.
constexpr int drawn_smoothing_rounds = 3;

/// Edge length [m] at a position.
using EdgeLength = std::function<float(const Vec3f&)>;

/// A drawn surface, with a resolution for close views.
TriangleMesh visible_mesh(const Anatomy& anatomy, const EdgeLength& edge, float VisibleFields::*organ,
                          const std::array<Vec3f, 2>& box, std::size_t budget) {
    const float size = anatomy.scale() / millimetre;
    AdaptiveField field;
    field.low = box[0];
    field.high = box[1];
    field.coarsest = 8e-3f * size;
    field.edge = edge;
    field.value = [&](std::span<const Vec3f> points, std::span<float> values) {
        constexpr std::size_t grain = 256;
        parallel::for_ranges(points.size(), grain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                values[i] = anatomy.visible_fields(points[i]).*organ;
            }
        });
    };
    TriangleMesh mesh = adaptive_isosurface(field);
    smooth_without_self_intersection(mesh, drawn_smoothing_rounds);
    if (mesh.triangles.size() <= budget) {
        return mesh;
    }
    // Weight of an error by the inverse square of the area of triangles with that edge.
    std::vector<float> importance(mesh.vertices.size());
    constexpr std::size_t grain = 256;
    parallel::for_each(importance.size(), grain, [&](std::size_t i) {
        importance[i] = std::pow(1e-3f * size / edge(mesh.vertices[i]), 4.0f);
        // The inner face of the cloth lies within the body.
        if (organ == &VisibleFields::cloth && anatomy.visible_fields(mesh.vertices[i]).body < 0.0f) {
            importance[i] *= 1e-3f;
        }
    });
    mesh = simplify_without_self_intersection(mesh, {.triangles = budget, .importance = importance});
    // Slivers left by collapsed edges shade as cracks before a lens.
    smooth_without_self_intersection(mesh, drawn_smoothing_rounds);
    return mesh;
}

/// Bones are visible in sections only, from a distance.
TriangleMesh bone_mesh(const DistanceGrid& field, std::size_t budget) {
    TriangleMesh mesh = isosurface(field, 0.0f);
    smooth_without_self_intersection(mesh, drawn_smoothing_rounds);
    return mesh.triangles.size() > budget
               ? simplify_without_self_intersection(mesh, {.triangles = budget, .importance = {}})
               : mesh;
}

Vec3f middle_of(const TriangleMesh& mesh, const Triangle& t) {
    return (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0f;
}

}  // namespace

void build_surfaces(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient) {
    const float size = anatomy.scale() / millimetre;
    const auto [low, high] = anatomy.bounds();
    const auto [inner_low, inner_high] = anatomy.airway_bounds();

    DistanceGrid skull = grid_over(low, high, 1.5f * settings.surface_spacing * size);
    DistanceGrid mandible = skull;
    DistanceGrid spine = skull;
    DistanceGrid hyoid = grid_over(inner_low, inner_high, 0.7f * settings.surface_spacing * size);
    sample(anatomy, skull, [&](std::size_t i, const Fields& f, const Vec3f&) {
        skull.value[i] = f.skull;
        mandible.value[i] = f.mandible;
        spine.value[i] = f.spine;
    });
    sample(anatomy, hyoid, [&](std::size_t i, const Fields& f, const Vec3f&) { hyoid.value[i] = f.hyoid; });

    const Vec3f tip = anatomy.landmarks()[static_cast<std::size_t>(Landmark::epiglottis_tip)];
    const Vec3f base = anatomy.landmarks()[static_cast<std::size_t>(Landmark::epiglottis_base)];
    const Vec3f margin = Vec3f::Constant(9e-3f * size);
    const SizingField detail(anatomy, settings.surface_spacing);

    struct Drawn {
        const char* name;
        Tissue tissue;
        std::size_t triangles;
        float VisibleFields::*organ;  // or nullptr,
        const DistanceGrid* bone;     // for organs sampled on a grid
        std::array<Vec3f, 2> box;
        EdgeLength edge = nullptr;
    };
    const std::array<Vec3f, 2> all = anatomy.visible_bounds();
    const EdgeLength of_body = [&](const Vec3f& p) { return detail.body_edge(p); };
    const EdgeLength of_cloth = [&](const Vec3f& p) { return detail.cloth_edge(p); };
    // The tongue's silhouette, with edges under 10 pixels in the trainee's view, needs a higher resolution
    // than other surfaces of the mouth.
    constexpr float tongue_finer = 0.6f;
    // The plate's rim is half a millimetre thick, and a lens sees all of it.
    constexpr float plate_finer = 0.6f;
    const EdgeLength of_plate = [&](const Vec3f& p) { return plate_finer * detail.edge(p); };
    const EdgeLength of_tongue = [&](const Vec3f& p) { return tongue_finer * detail.edge(p); };
    // The body takes as long as all others. The hyoid is embedded in soft tissue and moves with it.
    const std::array drawn = {
        Drawn{"body", Tissue::soft, settings.body_triangles, &VisibleFields::body, nullptr, all, of_body},
        Drawn{"tongue",
              Tissue::tongue,
              22000,
              &VisibleFields::tongue,
              nullptr,
              {inner_low, inner_high},
              of_tongue},
        Drawn{"epiglottis",
              Tissue::epiglottis,
              9000,
              &VisibleFields::epiglottis,
              nullptr,
              {tip.cwiseMin(base) - margin, tip.cwiseMax(base) + margin},
              of_plate},
        Drawn{"skull", Tissue::skull, 16000, nullptr, &skull, {}},
        Drawn{"mandible", Tissue::mandible, 4000, nullptr, &mandible, {}},
        Drawn{"spine", Tissue::spine, 8000, nullptr, &spine, {}},
        Drawn{"hyoid", Tissue::hyoid, 1500, nullptr, &hyoid, {}},
        Drawn{"cloth", Tissue::cloth, detail.whole_body() ? 8000u : 18000u, &VisibleFields::cloth, nullptr,
              all, of_cloth}};
    patient.surfaces.resize(drawn.size());
    parallel::for_each(drawn.size(), 1, [&](std::size_t i) {
        const Drawn& d = drawn[i];
        Surface& surface = patient.surfaces[i];
        surface.name = d.name;
        surface.tissue = d.tissue;
        surface.mesh = d.bone != nullptr ? bone_mesh(*d.bone, d.triangles)
                                         : visible_mesh(anatomy, d.edge, d.organ, d.box, d.triangles);
        for (const Triangle& t : surface.mesh.triangles) {
            surface.triangle_tissue.push_back(
                d.tissue == Tissue::soft ? anatomy.visible_tissue(middle_of(surface.mesh, t)) : d.tissue);
        }
    });
    // Patients from labels have no cloth.
    std::erase_if(patient.surfaces, [](const Surface& surface) {
        return surface.tissue == Tissue::cloth && surface.mesh.triangles.empty();
    });
}

}  // namespace eti::patient
