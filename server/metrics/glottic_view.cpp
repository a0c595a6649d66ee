// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/metrics/glottic_view.hpp"

#include <algorithm>
#include <cmath>

namespace eti::metrics {

AreaSamples sample_polygon(std::span<const Vec3f> contour, int count) {
    AreaSamples samples;
    if (contour.size() < 3) {
        return samples;
    }
    Vec3f centroid = Vec3f::Zero();
    for (const Vec3f& p : contour) {
        centroid += p / static_cast<float>(contour.size());
    }
    const int rings = std::max(
        1, static_cast<int>(std::lround(static_cast<double>(count) / static_cast<double>(contour.size()))));
    float total = 0.0f;
    for (std::size_t i = 0; i < contour.size(); ++i) {
        const Vec3f& a = contour[i];
        const Vec3f& b = contour[(i + 1) % contour.size()];
        const float area = 0.5f * (a - centroid).cross(b - centroid).norm();
        total += area;
        for (int ring = 0; ring < rings; ++ring) {
            // Radii that cut a fan triangle into strips of equal area, each sampled at its middle.
            const float radius = std::sqrt((static_cast<float>(ring) + 0.5f) / static_cast<float>(rings));
            samples.points.push_back(centroid + radius * (0.5f * (a + b) - centroid));
            samples.weights.push_back(area / static_cast<float>(rings));
        }
    }
    for (float& weight : samples.weights) {
        weight = total > 0.0f ? weight / total : 1.0f / static_cast<float>(samples.weights.size());
    }
    return samples;
}

GlotticViewer::GlotticViewer(const anatomy::Patient& patient, const Laryngoscope& scope)
    : GlotticViewer(patient, scope, Settings{}) {}

GlotticViewer::GlotticViewer(const anatomy::Patient& patient, const Laryngoscope& scope,
                             const Settings& settings)
    : settings_(settings),
      lips_as_scanned_(
          std::ranges::none_of(patient.surfaces, [](const Surface& s) { return s.tissue == Tissue::cloth; })),
      rest_centres_(patient.frame_rest_centre),
      scope_(scope) {
    for (const Surface& surface : patient.surfaces) {
        if (is_bone(surface.tissue)) {  // inside the body, hidden anyway
            continue;
        }
        surfaces_.emplace_back(surface.mesh, surface.skin);
        if (surface.tissue == Tissue::epiglottis && !surface.mesh.vertices.empty()) {
            const std::size_t count = surface.mesh.vertices.size();
            const std::size_t wanted = static_cast<std::size_t>(std::max(1, settings.epiglottis_samples));
            const std::size_t stride = std::max<std::size_t>(1, count / wanted);
            for (std::size_t i = 0; i < count; i += stride) {
                epiglottis_.push_back({surface.mesh.vertices[i], surface.skin[i]});
            }
        }
    }
    const TriangleMesh mesh = laryngoscope_mesh(scope);
    if (!mesh.triangles.empty()) {
        const SkinWeights rigid{{0}, {1.0f}};
        laryngoscope_.emplace(mesh, std::vector<SkinWeights>(mesh.vertices.size(), rigid));
    }
}

void GlotticViewer::block(SightLines& lines, std::span<const FrameMap> frames, const LipRetraction& lips,
                          const scene::Snapshot& snapshot) {
    if (laryngoscope_) {
        const FrameMap held = frame_map({snapshot.proxy.translation, snapshot.proxy.rotation}, Vec3f::Zero());
        laryngoscope_->block(lines, std::span(&held, 1));
    }
    const std::optional<PlacedGiveWay> pressed = give_way_to(scope_, snapshot.proxy, snapshot.landmarks);
    if (lips_as_scanned_) {
        lines.begin_at(std::max(0.0f, lines.seen_from_eye(at(snapshot.landmarks, Landmark::upper_gum)).z()));
    }
    for (Occluder& surface : surfaces_) {
        surface.block(lines, frames, pressed, &lips);
    }
    lines.begin_at(0.0f);
    if (settings_.tube_radius > 0.0f) {
        for (std::size_t i = 1; i < snapshot.tube_nodes.size(); ++i) {
            lines.block_by_capsule(lines.seen_from_eye(snapshot.tube_nodes[i - 1]),
                                   lines.seen_from_eye(snapshot.tube_nodes[i]), settings_.tube_radius);
        }
    }
}

GlotticView GlotticViewer::look(const scene::Snapshot& snapshot, const Vec3f& from) {
    GlotticView view;
    if (snapshot.frames.size() != rest_centres_.size()) {
        return view;
    }
    std::vector<FrameMap> frames(rest_centres_.size());
    std::ranges::transform(snapshot.frames, rest_centres_, frames.begin(), frame_map);
    const LipRetraction lips = lip_retraction(from, snapshot.landmarks);
    const AreaSamples samples = sample_polygon(snapshot.glottis_contour, settings_.samples);
    SightLines to_glottis(from, samples.points, settings_.tolerance);
    block(to_glottis, frames, lips, snapshot);
    for (std::size_t i = 0; i < to_glottis.size(); ++i) {
        if (!to_glottis.blocked(i)) {
            view.opening_percent += 100.0f * samples.weights[i];
        }
    }
    view.opening_percent = std::min(view.opening_percent, 100.0f);
    if (view.opening_percent > 0.0f) {
        return view;
    }

    const PlacedGiveWay pressed = give_way_to(scope_, snapshot.proxy, snapshot.landmarks);
    std::vector<Vec3f> targets;
    for (const anatomy::CarriedPoint& point : epiglottis_) {
        targets.push_back(pressed(skin_point(point.rest, point.skin, frames)));
    }
    SightLines to_epiglottis(from, targets, settings_.tolerance);
    block(to_epiglottis, frames, lips, snapshot);
    for (std::size_t i = 0; i < to_epiglottis.size() && !view.epiglottis_seen; ++i) {
        view.epiglottis_seen = !to_epiglottis.blocked(i);
    }
    return view;
}

}  // namespace eti::metrics
