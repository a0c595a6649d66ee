// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/metrics/glottic_view.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/model/tools/tube_end.hpp"

namespace eti::metrics {

std::vector<Vec3f> sample_polygon(std::span<const Vec3f> contour, int count) {
    if (contour.size() < 3 || count < 1) {
        return {};
    }
    Vec3f centroid = Vec3f::Zero();
    for (const Vec3f& p : contour) {
        centroid += p / static_cast<float>(contour.size());
    }
    // Cumulative area of the triangle fan about the centroid, up to each corner.
    std::vector<float> area{0.0f};
    for (std::size_t i = 0; i < contour.size(); ++i) {
        const Vec3f& next = contour[(i + 1) % contour.size()];
        area.push_back(area.back() + 0.5f * (contour[i] - centroid).cross(next - centroid).norm());
    }
    constexpr float golden = 0.61803399f;
    const int pairs = (count + 1) / 2;
    std::vector<Vec3f> points;
    for (int pair = 0; pair < pairs; ++pair) {
        const float out = std::sqrt((static_cast<float>(pair) + 0.5f) / static_cast<float>(pairs));
        for (const float opposite : {0.0f, 0.5f}) {
            const float turn = 0.5f * golden * static_cast<float>(pair) + opposite;
            const float swept = (turn - std::floor(turn)) * area.back();
            const auto beyond = std::upper_bound(area.begin() + 1, area.end() - 1, swept);
            const auto i = static_cast<std::size_t>(beyond - area.begin()) - 1;
            const float whole = area[i + 1] - area[i];
            const float along = whole > 0.0f ? std::min((swept - area[i]) / whole, 1.0f) : 0.5f;
            const Vec3f& a = contour[i];
            const Vec3f& b = contour[(i + 1) % contour.size()];
            points.push_back(centroid + out * (a + along * (b - a) - centroid));
        }
    }
    return points;
}

GlotticViewer::GlotticViewer(const patient::Patient& patient, const Laryngoscope& scope)
    : GlotticViewer(patient, scope, Settings{}) {}

GlotticViewer::GlotticViewer(const patient::Patient& patient, const Laryngoscope& scope,
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
    glottis_occluders_.resize(surfaces_.size());
    epiglottis_occluders_.resize(surfaces_.size());
    const TriangleMesh mesh = laryngoscope_mesh(scope);
    if (!mesh.triangles.empty()) {
        const SkinWeights rigid{{0}, {1.0f}};
        laryngoscope_.emplace(mesh, std::vector<SkinWeights>(mesh.vertices.size(), rigid));
    }
}

void GlotticViewer::block(SightLines& lines, const Occluder::DeformedState& tissue,
                          const scene::Snapshot& snapshot, OccluderCache& hiding) {
    if (settings_.tube_radius > 0.0f) {
        block_by_tube(lines, snapshot.tube_nodes);
    }
    if (laryngoscope_) {
        const WideFrameMap held =
            frame_map({snapshot.proxy.translation, snapshot.proxy.rotation}, Vec3f::Zero());
        Occluder::RecentBlocks of_the_blade;  // a small mesh: tested in full each time
        laryngoscope_->block(lines, {.frames = std::span(&held, 1)}, of_the_blade);
    }
    if (lips_as_scanned_) {
        lines.set_min_depth(
            std::max(0.0f, lines.to_eye_frame(at(snapshot.landmarks, Landmark::upper_gum)).z()));
    }
    // Recent blockers block most lines, which narrows the search for the rest.
    for (std::size_t i = 0; i < surfaces_.size() && !lines.all_blocked(); ++i) {
        surfaces_[i].block_by_recent(lines, tissue, hiding[i]);
    }
    lines.restrict_to_open_lines();
    for (std::size_t i = 0; i < surfaces_.size() && !lines.all_blocked(); ++i) {
        surfaces_[i].block(lines, tissue, hiding[i]);
    }
    lines.set_min_depth(0.0f);
}

void GlotticViewer::block_by_tube(SightLines& lines, std::span<const Vec3f> nodes) const {
    const std::optional<TubeEnd> end = tube_end(nodes, settings_.tube_radius);
    if (!end) {
        return;
    }
    Vec3f before = lines.to_eye_frame(nodes[0]);
    const Vec3f start = lines.to_eye_frame(end->start);
    for (std::size_t i = 1; i <= end->nodes; ++i) {
        const Vec3f next = i < end->nodes ? lines.to_eye_frame(nodes[i]) : start;
        lines.block_by_capsule(before, next, settings_.tube_radius);
        before = next;
    }
    lines.block_by_cut_cylinder(start, lines.to_eye_frame(end->tip), settings_.tube_radius,
                                lines.direction_in_eye_frame(end->bevel), end->beyond);
}

GlotticView GlotticViewer::evaluate(const scene::Snapshot& snapshot, const Vec3f& from) {
    GlotticView view;
    if (snapshot.frames.size() != rest_centres_.size()) {
        return view;
    }
    for (Occluder& surface : surfaces_) {
        surface.forget();
    }
    if (laryngoscope_) {
        laryngoscope_->forget();
    }
    std::vector<FrameMap> frames(rest_centres_.size());
    std::ranges::transform(snapshot.frames, rest_centres_, frames.begin(), frame_map);
    const std::vector<WideFrameMap> wide(frames.begin(), frames.end());
    const LipRetraction lips = lip_retraction(from, snapshot.landmarks);
    const std::vector<Vec3f> samples = sample_polygon(snapshot.glottis_contour, settings_.samples);
    SightLines to_glottis(from, samples, settings_.tolerance);
    const PosedBladeClearanceDeformer pressed =
        blade_clearance_for(scope_, snapshot.proxy, snapshot.landmarks);
    const Occluder::DeformedState tissue{wide, pressed, &lips};
    block(to_glottis, tissue, snapshot, glottis_occluders_);
    view.opening_percent = to_glottis.open_percent();
    if (view.opening_percent > 0.0f) {
        return view;
    }

    std::vector<Vec3f> targets;
    for (const patient::CarriedPoint& point : epiglottis_) {
        targets.push_back(pressed(skin_point(point.rest, point.skin, frames)));
    }
    SightLines to_epiglottis(from, targets, settings_.tolerance);
    block(to_epiglottis, tissue, snapshot, epiglottis_occluders_);
    view.epiglottis_seen = !to_epiglottis.all_blocked();
    return view;
}

}  // namespace eti::metrics
