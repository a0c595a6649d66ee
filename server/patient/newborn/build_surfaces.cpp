// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <array>
#include <cmath>

#include "common/math/units.hpp"
#include "common/mesh/distance.hpp"
#include "common/mesh/isosurface.hpp"
#include "common/mesh/point_grid.hpp"
#include "common/mesh/uncrossed.hpp"
#include "server/parallel/loops.hpp"
#include "server/patient/model/stiffness.hpp"
#include "server/patient/newborn/build.hpp"
#include "server/patient/newborn/newborn.hpp"

namespace eti::anatomy {

namespace {

// Takes the slivers of marching tetrahedra out, which would keep edges from collapsing; moves vertices by
// a tenth of the grid's spacing.
constexpr int smoothing = 3;

constexpr float shell_band = 4e-3f;  // [m], within which the shell's distances are exact

DistanceGrid grid_over(const Vec3f& low, const Vec3f& high, float spacing) {
    DistanceGrid grid;
    grid.origin = low;
    grid.spacing = spacing;
    for (int k = 0; k < 3; ++k) {
        grid.size[static_cast<std::size_t>(k)] =
            static_cast<int>(std::ceil((high[k] - low[k]) / spacing)) + 1;
    }
    grid.value.resize(static_cast<std::size_t>(grid.size[0]) * grid.size[1] * grid.size[2]);
    return grid;
}

/// Evaluates the fields on a grid once and hands them to `store(node index, fields, point)`.
template <class Store>
void sample(const Anatomy& anatomy, const DistanceGrid& grid, const Store& store) {
    parallel::for_each(grid.size[2], 1, [&](int z) {
        for (int y = 0; y < grid.size[1]; ++y) {
            for (int x = 0; x < grid.size[0]; ++x) {
                const Vec3f point = grid.node(x, y, z);
                store(grid.index(x, y, z), anatomy.fields(point), point);
            }
        }
    });
}

float visible_tongue(const Fields& f) {
    return std::max(f.tongue, -f.sublingual);
}

/// The body without tongue and epiglottis; the tongue sinks a little into the mouth floor, so that no
/// gap shows between their surfaces.
float body_field(const Fields& f, float tongue, float overlap) {
    return std::max(f.skin, -std::min(f.cavity, tongue + overlap));
}

/// Without skin weights.
Surface surface_from(const Anatomy& anatomy, const DistanceGrid& field, std::string name, Tissue tissue,
                     std::size_t budget) {
    Surface surface;
    surface.name = std::move(name);
    surface.tissue = tissue;
    surface.mesh = isosurface(field, 0.0f);
    smooth_without_crossing(surface.mesh, smoothing);
    if (budget > 0 && surface.mesh.triangles.size() > budget) {
        // The lining of the airway is looked at from near: keep it fine, let the scalp go coarse.
        std::vector<float> importance(surface.mesh.vertices.size(), 1.0f);
        const auto [low, high] = anatomy.airway_bounds();
        for (std::size_t i = 0; i < importance.size(); ++i) {
            const Vec3f& p = surface.mesh.vertices[i];
            const bool near = (p.array() > low.array()).all() && (p.array() < high.array()).all();
            importance[i] = near ? 8.0f : 1.0f;
        }
        surface.mesh =
            simplify_without_crossing(surface.mesh, {.triangles = budget, .importance = importance});
    }
    for (const Triangle& t : surface.mesh.triangles) {
        const Vec3f middle =
            (surface.mesh.vertices[t[0]] + surface.mesh.vertices[t[1]] + surface.mesh.vertices[t[2]]) / 3.0f;
        surface.triangle_tissue.push_back(tissue == Tissue::soft ? lining_tissue(anatomy, middle) : tissue);
    }
    return surface;
}

}  // namespace

Tissue lining_tissue(const Anatomy& anatomy, const Vec3f& point) {
    const Fields f = anatomy.fields(point);
    const float margin = 0.6f * anatomy.scale();
    const Vec3f model = anatomy.to_model(point);
    if (f.upper_gum < margin) {
        return Tissue::upper_gum;
    }
    if (f.lower_gum < margin) {
        return Tissue::lower_gum;
    }
    if (f.palate < margin) {
        return Tissue::palate;
    }
    if (f.larynx < margin) {
        return model.z() < -46.0f ? Tissue::trachea : Tissue::larynx;
    }
    if (model.z() < -41.0f && f.cavity < margin && f.skin < -3.0f * margin) {
        return Tissue::oesophagus;
    }
    return Tissue::soft;
}

void build_surfaces(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient) {
    const float size = anatomy.scale() / millimetre;
    const auto [low, high] = anatomy.bounds();
    const auto [inner_low, inner_high] = anatomy.airway_bounds();

    DistanceGrid body = grid_over(low, high, settings.surface_spacing * size);
    DistanceGrid skull = grid_over(low, high, 1.5f * settings.surface_spacing * size);
    DistanceGrid mandible = skull;
    DistanceGrid spine = skull;
    DistanceGrid hyoid = grid_over(inner_low, inner_high, 0.7f * settings.surface_spacing * size);
    sample(anatomy, body, [&](std::size_t i, const Fields& f, const Vec3f&) {
        body.value[i] = body_field(f, visible_tongue(f), 0.5e-3f * size);
    });
    sample(anatomy, skull, [&](std::size_t i, const Fields& f, const Vec3f&) {
        skull.value[i] = f.skull;
        mandible.value[i] = f.mandible;
        spine.value[i] = f.spine;
    });
    sample(anatomy, hyoid, [&](std::size_t i, const Fields& f, const Vec3f&) { hyoid.value[i] = f.hyoid; });
    DistanceGrid tongue = grid_over(inner_low, inner_high, settings.surface_spacing * size);
    sample(anatomy, tongue,
           [&](std::size_t i, const Fields& f, const Vec3f&) { tongue.value[i] = visible_tongue(f); });
    const Vec3f tip = anatomy.landmarks()[static_cast<std::size_t>(Landmark::epiglottis_tip)];
    const Vec3f base = anatomy.landmarks()[static_cast<std::size_t>(Landmark::epiglottis_base)];
    const Vec3f margin = Vec3f::Constant(9e-3f * size);
    DistanceGrid epiglottis = grid_over(tip.cwiseMin(base) - margin, tip.cwiseMax(base) + margin,
                                        0.4f * settings.surface_spacing * size);
    sample(anatomy, epiglottis,
           [&](std::size_t i, const Fields& f, const Vec3f&) { epiglottis.value[i] = f.epiglottis; });

    struct Wanted {
        const char* name;
        Tissue tissue;
        std::size_t triangles;
        const DistanceGrid& grid;
    };
    // The body takes as long as all others. The hyoid hangs in the soft tissue and goes with it.
    const std::array wanted = {Wanted{"body", Tissue::soft, settings.body_triangles, body},
                               Wanted{"tongue", Tissue::tongue, 6000, tongue},
                               Wanted{"epiglottis", Tissue::epiglottis, 3000, epiglottis},
                               Wanted{"skull", Tissue::skull, 16000, skull},
                               Wanted{"mandible", Tissue::mandible, 4000, mandible},
                               Wanted{"spine", Tissue::spine, 8000, spine},
                               Wanted{"hyoid", Tissue::hyoid, 1500, hyoid}};
    patient.surfaces.resize(wanted.size());
    parallel::for_each(wanted.size(), 1, [&](std::size_t i) {
        const auto& [name, tissue, triangles, grid] = wanted[i];
        patient.surfaces[i] = surface_from(anatomy, grid, name, tissue, triangles);
    });
}

void build_shell(const Anatomy& anatomy, const BuildSettings& settings, Patient& patient) {
    const float size = anatomy.scale() / millimetre;
    const auto [low, high] = anatomy.airway_bounds();
    // The face belongs to it: a blade must not pass through lips and nose.
    const Vec3f room(10e-3f * size, 12e-3f * size, 8e-3f * size);
    DistanceGrid field = grid_over(low - room, high + room, 1.0e-3f * size);
    sample(anatomy, field, [&](std::size_t i, const Fields& f, const Vec3f& point) {
        field.value[i] = body_field(f, f.tongue, 0.0f) + anatomy.shell_offset(point, f);
    });
    TriangleMesh shell = isosurface(field, 0.0f);
    // Operators are tuned to this shell: a few crossings less than a millimetre deep are not worth another.
    smooth(shell, smoothing);
    patient.shell.mesh = simplify(shell, {.triangles = settings.shell_triangles, .importance = {}});
    patient.shell.distance =
        mesh_distance(patient.shell.mesh, field.origin, field.spacing, field.size, shell_band);
    for (const Triangle& t : patient.shell.mesh.triangles) {
        const auto& v = patient.shell.mesh.vertices;
        patient.shell.triangle_tissue.push_back(lining_tissue(anatomy, (v[t[0]] + v[t[1]] + v[t[2]]) / 3.0f));
    }
    for (const Vec3f& v : patient.shell.mesh.vertices) {
        patient.shell.vertex_bones.push_back(anatomy.bone_weights(v, lining_tissue(anatomy, v)));
    }
}

Patient build_patient(const Anatomy& anatomy, const BuildSettings& settings, const Patient* formed) {
    Patient patient;
    patient.weight = anatomy.weight();
    patient.skeleton = anatomy.skeleton();
    build_particles(anatomy, settings, patient);
    build_clusters(anatomy, settings, patient);
    build_tetrahedra(anatomy, patient);
    build_links(anatomy, settings, patient);
    set_tissue_stiffness(patient, settings.tissue_stiffness);
    build_frames(patient);
    if (formed != nullptr) {
        patient.surfaces = formed->surfaces;
        patient.shell = formed->shell;
    } else {
        parallel::both([&] { build_surfaces(anatomy, settings, patient); },
                       [&] { build_shell(anatomy, settings, patient); });
    }
    skin_surfaces(anatomy, settings, patient);
    build_landmarks(anatomy, settings, patient);
    return patient;
}

Patient build_patient(const NewbornShape& shape, const BuildSettings& settings, const Patient* formed) {
    return build_patient(Newborn(shape), settings, formed);
}

}  // namespace eti::anatomy
