// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/surfaces.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "common/mesh/isosurface.hpp"
#include "server/patient/imaging/filter.hpp"
#include "server/patient/mesh/without_self_intersection.hpp"

namespace eti::segmentation {

namespace {

using imaging::Bits;
using imaging::Geometry;

/// Negative inside. The grid is in index space: origin 0, spacing 1.
DistanceGrid field_of(const Geometry& g, const Bits& member, const imaging::Volume* ct, float threshold) {
    DistanceGrid field;
    field.spacing = 1.0f;
    field.size = g.size;
    field.value.resize(g.count());
    if (ct == nullptr) {
        std::vector<float> value(member.begin(), member.end());
        const Bits everywhere(member.size(), 1);
        const std::vector<float> blurred = imaging::smooth_within(g.size, value, everywhere, 0.8f);
        for (std::size_t i = 0; i < member.size(); ++i) {
            field.value[i] = 0.5f - blurred[i];
        }
        return field;
    }
    for (std::size_t i = 0; i < member.size(); ++i) {
        // The labels give the sign, the grey value the magnitude: where both agree this is the grey-value
        // field.
        const float away = std::clamp(std::fabs(ct->value[i] - threshold), 1.0f, 600.0f);
        field.value[i] = member[i] != 0 ? -away : away;
    }
    return field;
}

/// From indices to metres; a left-handed grid would turn the surface inside out.
void place(TriangleMesh& mesh, const Geometry& g) {
    for (Vec3f& v : mesh.vertices) {
        v = (g.origin + g.step * v.cast<double>()).cast<float>();
    }
    if (g.step.determinant() < 0.0) {
        for (Triangle& t : mesh.triangles) {
            std::swap(t[1], t[2]);
        }
    }
}

void require_same_grid(const imaging::Mask& labels, const imaging::Volume& ct) {
    const Geometry& a = labels.geometry;
    const Geometry& b = ct.geometry;
    if (a.size != b.size || (a.step - b.step).norm() > 1e-3 * b.step.norm() ||
        (a.origin - b.origin).norm() > 0.1 * b.spacing().minCoeff()) {
        throw imaging::VolumeError(
            fmt::format("labels ({} x {} x {}) and CT ({} x {} x {}) are not on the same grid. Remedy: give "
                        "the CT that was segmented.",
                        a.size[0], a.size[1], a.size[2], b.size[0], b.size[1], b.size[2]));
    }
}

/// Simplifies the surface to its budget of triangles, or to more where a coarse surface would cross itself:
/// the border of bone in a noisy CT is folded more finely than the budget's triangles.
void simplify_to(std::size_t budget, NamedSurface& surface) {
    const TriangleMesh fine = std::move(surface.mesh);
    for (; budget < fine.triangles.size(); budget *= 2) {
        surface.mesh = simplify_without_self_intersection(fine, {.triangles = budget, .importance = {}});
        surface.report = check(surface.mesh);
        if (surface.report.is_valid()) {
            return;
        }
    }
    surface.mesh = fine;
    surface.report = check(surface.mesh);
}

}  // namespace

std::vector<NamedSurface> make_surfaces(const imaging::Mask& labels, const imaging::Volume* ct,
                                        const SurfaceSettings& settings, const Progress& progress) {
    if (ct != nullptr) {
        require_same_grid(labels, *ct);
    }
    const Geometry& g = labels.geometry;
    const auto is = [](std::uint8_t value, std::initializer_list<Label> which) {
        return std::any_of(which.begin(), which.end(), [&](Label l) { return value == value_of(l); });
    };
    struct Wanted {
        const char* name;
        std::size_t budget;
        float threshold;
    };
    const std::array<Wanted, 3> all = {{{"skin", settings.skin_triangles, settings.air_below},
                                        {"bone", settings.bone_triangles, settings.bone_above},
                                        {"airway", settings.airway_triangles, settings.air_below}}};
    std::vector<NamedSurface> surfaces;
    for (std::size_t k = 0; k < all.size(); ++k) {
        const Wanted& wanted = all[k];
        if (!progress(static_cast<float>(k) / static_cast<float>(all.size()), wanted.name)) {
            throw CancelledError();
        }
        Bits member(labels.value.size());
        bool any = false;
        for (std::size_t i = 0; i < member.size(); ++i) {
            const std::uint8_t v = labels.value[i];
            const bool in = k == 0   ? !is(v, {Label::outside})
                            : k == 1 ? is(v, {Label::bone, Label::mandible, Label::spine})
                                     : is(v, {Label::airway});
            member[i] = in ? 1 : 0;
            any = any || in;
        }
        if (!any) {
            continue;
        }
        NamedSurface surface;
        surface.name = wanted.name;
        surface.mesh = isosurface(field_of(g, member, ct, wanted.threshold), 0.0f);
        place(surface.mesh, g);
        smooth_without_self_intersection(surface.mesh, settings.smoothing);
        simplify_to(wanted.budget, surface);
        if (!surface.report.is_valid()) {
            const Vec3f at = 1e3f * surface.report.fault_at.value_or(Vec3f::Zero());
            throw imaging::VolumeError(
                fmt::format("the surface of {} is not valid, first near ({:.1f}, {:.1f}, {:.1f}) mm: {}; "
                            "expected a closed, manifold, oriented surface that does not cross itself. "
                            "Remedy: correct the labels there.",
                            wanted.name, at.x(), at.y(), at.z(), surface.report.describe()));
        }
        surfaces.push_back(std::move(surface));
    }
    return surfaces;
}

imaging::Bytes encode_stl(const TriangleMesh& mesh) {
    imaging::Bytes out(80, ' ');
    constexpr std::string_view title = "NeoETI surface, millimetres, LPS";
    std::copy(title.begin(), title.end(), out.begin());
    imaging::store(out, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const Triangle& t : mesh.triangles) {
        const std::array<Vec3f, 3> p = {1e3f * mesh.vertices[t[0]], 1e3f * mesh.vertices[t[1]],
                                        1e3f * mesh.vertices[t[2]]};
        const Vec3f normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
        for (const Vec3f& v : {normal, p[0], p[1], p[2]}) {
            for (int k = 0; k < 3; ++k) {
                imaging::store(out, v[k]);
            }
        }
        imaging::store(out, std::uint16_t{0});
    }
    return out;
}

}  // namespace eti::segmentation
