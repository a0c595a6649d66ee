// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/model/thresholds.hpp"
#include "common/model/tools/tools.hpp"
#include "server/metrics/occluders.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/snapshot.hpp"

namespace eti::metrics {

/// View of the larynx from an eye position.
struct GlotticView {
    float opening_percent = 0.0f;  ///< POGO: visible share of the glottic opening's area
    bool epiglottis_seen = false;  ///< tested only where none of the opening is visible
};

/// Samples a closed polygon's area with `count` points, or one more, of equal weight: a sunflower spiral
/// (Vogel 1979, Math Biosci 44:179) over the triangle fan from the centroid, in pairs across the centroid.
/// Returns no points for a polygon without sides.
[[nodiscard]] std::vector<Vec3f> sample_polygon(std::span<const Vec3f> contour, int count);

/// Percentage of glottic opening (Levitan 1998, Acad Emerg Med 5:919), measured as a share of area: sight
/// lines from the eye to points of the opening that are blocked by neither the patient's skinned surfaces nor
/// laryngoscope nor tube. Lips are retracted, as in the trainee's picture.
class GlotticViewer {
  public:
    struct Settings {
        int samples = static_cast<int>(threshold::glottis_points.value);
        int epiglottis_samples = static_cast<int>(threshold::epiglottis_points.value);
        float tolerance = threshold::hiding_distance.as_float();  ///< [m]
        float tube_radius = 2.1e-3f;                              ///< [m]; 0: no tube
    };

    /// Copies what it needs from the patient.
    GlotticViewer(const patient::Patient& patient, const Laryngoscope& scope, const Settings& settings);
    GlotticViewer(const patient::Patient& patient, const Laryngoscope& scope);

    /// `from` [m], patient frame: the eye. The snapshot must be of the same patient.
    [[nodiscard]] GlotticView evaluate(const scene::Snapshot& snapshot, const Vec3f& from);

  private:
    using OccluderCache = std::vector<Occluder::RecentBlocks>;  // one entry per surface

    void block(SightLines& lines, const Occluder::DeformedState& tissue, const scene::Snapshot& snapshot,
               OccluderCache& hiding);
    void block_by_tube(SightLines& lines, std::span<const Vec3f> nodes) const;

    Settings settings_;
    /// Patients segmented from a CT were scanned with closed lips and have no neutral lip geometry. The lips
    /// are taken as parted by fingers: nothing anterior to the upper gum blocks.
    bool lips_as_scanned_;
    std::vector<Vec3f> rest_centres_;
    std::vector<Occluder> surfaces_;
    std::optional<Occluder> laryngoscope_;
    Laryngoscope scope_;
    std::vector<patient::CarriedPoint> epiglottis_;
    OccluderCache glottis_occluders_, epiglottis_occluders_;
};

}  // namespace eti::metrics
